// camera.js - where the eye is, and the hands that move it. The camera turns about what it looks at.
import {add, cross, dot, length, scale, sub, turn, unit} from "./vector.js";
import {diagonal} from "./state.js";

const RIGHT_ANGLES = [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]];
export const AXES = RIGHT_ANGLES.map(v => v.join());

// The names of the six sides, with what lies there where the file says: "+X L".
export function sides(volume) {
  return AXES.map((_, k) => `${"+−"[k % 2]}${"XYZ"[k >> 1]} ${volume?.ends[k] ?? ""}`.trim());
}

// ---- what moves do to a camera {eye, lookAt, up, fov, ortho} ----

export function frame(c) {
  const back = unit(sub(c.eye, c.lookAt));
  const right = unit(cross(c.up, back));
  return {back, right, up: cross(back, right), distance: length(sub(c.eye, c.lookAt))};
}

// About the axis that points up, then about the picture's x; never over the poles.
function turned(v, c, yaw, pitch) {
  const axis = unit(c.up), {right} = frame(c);
  const polar = Math.acos(Math.max(-1, Math.min(1, dot(unit(v), axis))));
  const limit = 0.01;
  const tilt = Math.max(limit - polar, Math.min(Math.PI - limit - polar, pitch));
  return turn(turn(v, right, tilt), axis, yaw);
}

export function orbit(c, yaw, pitch) {
  c.eye = add(c.lookAt, turned(sub(c.eye, c.lookAt), c, yaw, pitch));
}

export function look(c, yaw, pitch) {
  const away = sub(c.eye, c.lookAt);
  c.lookAt = sub(c.eye, turned(away, c, yaw, pitch));
}

// By shares of the picture's height.
export function pan(c, x, y) {
  const f = frame(c), height = 2 * f.distance * Math.tan(c.fov * Math.PI / 360);
  const by = add(scale(f.right, -x * height), scale(f.up, y * height));
  c.eye = add(c.eye, by);
  c.lookAt = add(c.lookAt, by);
}

export function dolly(c, factor, volume) {
  const away = sub(c.eye, c.lookAt), d = diagonal(volume);
  const distance = Math.max(1e-4 * d, Math.min(50 * d, length(away) * factor));
  c.eye = add(c.lookAt, scale(unit(away), distance));
}

export function roll(c, angle) {
  const f = frame(c);
  c.up = turn(f.up, f.back, angle);
}

export function move(c, right, up, forward) {
  const f = frame(c);
  const by = add(add(scale(f.right, right), scale(f.up, up)), scale(f.back, -forward));
  c.eye = add(c.eye, by);
  c.lookAt = add(c.lookAt, by);
}

// The nearest camera of this direction that has all corners of a box in its picture.
// margin: how much farther than where the corners are at the picture's edge.
export function fit(c, [low, high], aspect, margin = 1.04) {
  const f = frame(c), middle = scale(add(low, high), 0.5), tan = Math.tan(c.fov * Math.PI / 360);
  let distance = 0;
  for (let k = 0; k < 8; k++) {
    const corner = sub([0, 1, 2].map(a => (k >> a & 1 ? high : low)[a]), middle);
    const across = Math.max(Math.abs(dot(corner, f.right)) / aspect, Math.abs(dot(corner, f.up)));
    distance = Math.max(distance, across / tan + (c.ortho ? 0 : dot(corner, f.back)));
  }
  c.lookAt = middle;
  c.eye = add(middle, scale(f.back, (distance || 1) * margin));
}

// Back, at most by a factor, until no corner of a box is beside the picture.
export function widen(c, [low, high], aspect, most) {
  const f = frame(c), tan = Math.tan(c.fov * Math.PI / 360) * aspect;
  let distance = f.distance;
  for (let k = 0; k < 8; k++) {
    const corner = sub([0, 1, 2].map(a => (k >> a & 1 ? high : low)[a]), c.lookAt);
    const across = 1.04 * Math.abs(dot(corner, f.right)) / tan;
    distance = Math.max(distance, across + (c.ortho ? 0 : dot(corner, f.back)));
  }
  c.eye = add(c.lookAt, scale(f.back, Math.min(distance, most * f.distance)));
}

const along = (a, b) => Math.abs(dot(unit(a), unit(b))) > 0.999;

// up: what points up, unless it is looked along.
export function axisView(c, which, up) {
  const back = RIGHT_ANGLES[which];
  c.eye = add(c.lookAt, scale(back, frame(c).distance));
  c.up = [up, [0, 1, 0], [0, 0, 1]].find(v => !along(v, back));
}

// What points up in all views but one along it: an axis, or z.
export function upward(c) {
  const {back} = frame(c), lies = along(back, [0, 0, 1]) && c.up[2] === 0;
  return AXES.includes(c.up.join()) && !lies ? [...c.up] : [0, 0, 1];
}

// Where up is looked along, the eye moves beside it.
export function setUp(c, up) {
  const away = sub(c.eye, c.lookAt);
  if (along(away, up)) c.eye = add(c.lookAt, turn(away, unit(cross(up, Math.abs(up[0]) < 0.9 ? [1, 0, 0] : [0, 1, 0])), 0.6));
  c.up = up;
}

// Where a point is in the picture, in shares of its width and height; null: behind the eye.
export function project(c, point, aspect) {
  const f = frame(c), v = sub(point, c.eye), depth = -dot(v, f.back);
  const tan = Math.tan(c.fov * Math.PI / 360) * (c.ortho ? f.distance : depth);
  if (depth <= 0 && !c.ortho) return null;
  return [0.5 + dot(v, f.right) / (2 * tan * aspect), 0.5 - dot(v, f.up) / (2 * tan)];
}

// ---- hands ----

const TURN = 0.008, KEY_TURN = Math.PI / 36, CLICK = 5, TAP_MS = 500;

// drive() - pointers, wheel and keys of the canvas. app: camera(), volume(), changed(moving),
// clicked(event), pivot(event), key(event) -> bool, flying()
export function drive(canvas, app) {
  const pointers = new Map();
  let travelled = 0, pressed = 0, gap = 0, middle = null;
  const held = new Set();
  let last = 0;

  const spread = () => {
    const [a, b] = [...pointers.values()];
    return {gap: Math.hypot(a.x - b.x, a.y - b.y), x: (a.x + b.x) / 2, y: (a.y + b.y) / 2};
  };

  canvas.addEventListener("pointerdown", event => {
    canvas.focus({preventScroll: true});
    canvas.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, {x: event.clientX, y: event.clientY});
    if (pointers.size === 1) { travelled = 0; pressed = performance.now(); }
    if (pointers.size === 2) { ({gap} = middle = spread()); travelled = Infinity; }
  });

  canvas.addEventListener("pointermove", event => {
    const before = pointers.get(event.pointerId), c = app.camera();
    if (!before || !c) return;
    const dx = event.clientX - before.x, dy = event.clientY - before.y;
    pointers.set(event.pointerId, {x: event.clientX, y: event.clientY});
    travelled += Math.abs(dx) + Math.abs(dy);
    if (travelled < CLICK) return;
    const height = canvas.clientHeight || 1;
    if (pointers.size >= 2) {
      const now = spread();
      pan(c, (now.x - middle.x) / height, (now.y - middle.y) / height);
      dolly(c, gap / (now.gap || 1), app.volume());
      gap = now.gap;
      middle = now;
    } else if (event.altKey) roll(c, dx * TURN);
    else if (event.shiftKey || event.buttons & 6) pan(c, dx / height, dy / height);
    else if (app.flying()) look(c, dx * TURN / 2, dy * TURN / 2);
    else orbit(c, -dx * TURN, -dy * TURN);
    app.changed(true);
  });

  const up = event => {
    if (!pointers.delete(event.pointerId)) return;
    if (event.type === "pointerup" && travelled < CLICK && event.button === 0 && performance.now() - pressed < TAP_MS)
      app.clicked(event);
    if (travelled >= CLICK) app.changed(false);
  };
  canvas.addEventListener("pointerup", up);
  canvas.addEventListener("pointercancel", up);
  canvas.addEventListener("contextmenu", event => event.preventDefault());
  canvas.addEventListener("dblclick", event => app.pivot(event));
  canvas.addEventListener("wheel", event => {
    event.preventDefault();
    if (!app.camera()) return;
    const pixels = event.deltaY * [1, 30, 300][event.deltaMode];
    if (app.flying()) move(app.camera(), 0, 0, -pixels * 0.0004 * diagonal(app.volume()));
    else dolly(app.camera(), Math.exp(Math.max(-300, Math.min(300, pixels)) * 0.0014), app.volume());
    app.changed(true);
  }, {passive: false});

  // ---- keys: those that are held move from picture to picture ----

  const MOVES = {w: [0, 0, 1], s: [0, 0, -1], a: [-1, 0, 0], d: [1, 0, 0], e: [0, 1, 0], q: [0, -1, 0]};
  const glide = now => {
    const c = app.camera();
    if (!c) held.clear();
    if (!held.size) return;
    const seconds = Math.min(0.1, (now - last) / 1000);
    last = now;
    const speed = 0.35 * diagonal(app.volume()) * seconds, sum = [0, 0, 0];
    for (const key of held) MOVES[key].forEach((x, i) => { sum[i] += x; });
    move(c, ...sum.map(x => x * speed));
    app.changed(true);
    requestAnimationFrame(glide);
  };

  const KEYS = {
    ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1],
  };
  canvas.addEventListener("keydown", event => {
    const c = app.camera(), key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
    if (!c || event.ctrlKey || event.metaKey || event.altKey) return;
    if (KEYS[key]) {
      const [x, y] = KEYS[key];
      if (event.shiftKey) pan(c, x * 0.04, y * 0.04);
      else if (app.flying()) look(c, -x * KEY_TURN / 2, -y * KEY_TURN / 2);
      else orbit(c, -x * KEY_TURN, -y * KEY_TURN);
    } else if (key === "+" || key === "=") dolly(c, 0.9, app.volume());
    else if (key === "-") dolly(c, 1 / 0.9, app.volume());
    else if (key === "[" || key === "]") roll(c, key === "[" ? KEY_TURN : -KEY_TURN);
    else if (MOVES[key]) {
      if (!held.size) { last = performance.now(); requestAnimationFrame(glide); }
      held.add(key);
    } else return;
    event.preventDefault();
    app.changed(true);
  });
  canvas.addEventListener("keyup", event => held.delete(event.key.toLowerCase()));
  canvas.addEventListener("blur", () => held.clear());
}
