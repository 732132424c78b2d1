// slice.js - slices through the volume beside the picture: across the three axes, and one that is oblique.
//
// Each is a picture of `leafcast slice`, in the colours of the volume. The wheel and the slider below a
// pane move it; a click moves the others to the point.
import {project} from "./camera.js";
import {byId, check, choice, element, slider, span} from "./dom.js";
import {centre, command, diagonal, stepOf, windowOf} from "./state.js";
import {add, cross, dot, scale, sub, unit} from "./vector.js";

const NAMES = ["x", "y", "z", "oblique"], TITLES = ["X", "Y", "Z", "Oblique"];
const COLOURS = ["#ee8277", "#7cc48f", "#8db9f5", "#e3c08a"]; // of labels and outlines
const SIDE_MAX = 4096, STEPS = 200, PIXELS_MAX = 1 << 22;
const NS = "http://www.w3.org/2000/svg";

// ---- the state: what no flag of render says is in "page" ----

export function slicesOf(page, volume) {
  const given = page?.slices ?? {}, shown = Array.isArray(given.shown) ? given.shown : [], middle = centre(volume);
  const number = (x, other) => Number.isFinite(x) ? x : other;
  return {
    on: NAMES.map(name => shown.includes(name)),
    at: middle.map((x, a) => number(given.at?.[a], x)),
    azimuth: number(given.azimuth, 45), elevation: number(given.elevation, 30), offset: number(given.offset, 0),
    isolines: given.isolines !== false, nearest: given.nearest === true,
    map: typeof given["colour-map"] === "string" ? given["colour-map"] : "",
    window: Array.isArray(given.window) && given.window.length === 2 ? given.window.map(Number) : null,
  };
}

// null, where no slice is shown.
export function slicesPage(s) {
  if (!s.on.some(Boolean)) return null;
  const slices = {shown: NAMES.filter((_, k) => s.on[k]), at: s.at};
  if (s.on[3]) Object.assign(slices, {azimuth: s.azimuth, elevation: s.elevation, offset: s.offset});
  if (!s.isolines) slices.isolines = false;
  if (s.nearest) slices.nearest = true;
  if (s.map) slices["colour-map"] = s.map;
  if (s.window) slices.window = s.window;
  return slices;
}

function normal(s) {
  const a = s.azimuth * Math.PI / 180, e = s.elevation * Math.PI / 180;
  return [Math.cos(e) * Math.cos(a), Math.cos(e) * Math.sin(a), Math.sin(e)];
}

const AS_VOLUME = "volume"; // in place of a map: as the transfer function colours values
const SOFT_TISSUE = [-160, 240]; // Hounsfield units: level 40, window 400

const asVolume = model => model.slices.map === AS_VOLUME && model.volume.mode !== "off";

// Over which values a slice's map is spread. Of CT it is what shows organs, unless another window is said.
function sliceWindow(model, field) {
  const {slices: s, volume: v} = model, [low, high] = field.data;
  const ct = !s.map && v.mode === "media" && v.preset === "ct" && low < SOFT_TISSUE[0] && high > SOFT_TISSUE[1];
  return s.window ?? (ct ? SOFT_TISSUE : null);
}

// Grey, by a map that is chosen, or as the transfer function colours values.
function colourFlags(model, volume) {
  const s = model.slices, v = model.volume, flags = {}, field = volume.fields[model.data.field];
  const spread = (map, own) => {
    const window = windowOf(own, field, volume);
    Object.assign(flags, {"colour-map": map}, window ? {window} : {});
  };
  if (!asVolume(model)) spread(s.map && s.map !== AS_VOLUME ? s.map : "grey", sliceWindow(model, field));
  else {
    const preset = v.mode === "media" && v.preset !== "custom";
    if (preset) flags.tf = v.preset;
    if (v.map || !preset) spread(v.map || (v.mode === "media" ? "viridis" : "grey"), v.window);
  }
  return flags;
}

const away = (a, b) => Math.hypot(...[1, 3, 5].map(i => parseInt(a.slice(i, i + 2), 16) - parseInt(b.slice(i, i + 2), 16)));
const SEEN = 90; // of 441, from black to white: how far a line's colour is from what is beside it, at least

// Of isolines: the surface's own where that is seen, else what is seen best. beside: the slice's colours at the isovalues.
export function lineColour(own, beside) {
  const least = c => Math.min(...beside.map(b => away(c, b)));
  return [own, "#ffffff", "#000000"].find(c => least(c) >= SEEN) ??
    ["#ff9f1c", "#00e5ff", "#ffffff", "#000000"].sort((a, b) => least(b) - least(a))[0];
}

// The colours that slices have at these values, as far as the page knows.
function coloursAt(values, flags, model, volume) {
  const field = volume.fields[model.data.field], preset = stepOf(field, model.data.step).presets[flags.tf];
  const ends = flags.window ?? (flags["colour-map"] || !preset ? field.data : [preset.points[0][0], preset.points.at(-1)[0]]);
  const colours = volume.colour_maps[flags["colour-map"]] ?? preset?.colours;
  return colours ? values.map(x => colours[Math.round(Math.min(1, Math.max(0, (x - ends[0]) / (ends[1] - ends[0] || 1))) *
    (colours.length - 1))]) : [];
}

// The flags of `leafcast slice` for a pane.
export function sliceFlags(model, volume, k) {
  const s = model.slices, flags = {};
  if (k < 3) Object.assign(flags, {axis: NAMES[k], at: s.at[k]});
  else {
    const n = normal(s);
    flags.plane = [...n, -dot(n, centre(volume)) - s.offset];
  }
  if (volume.fields.length > 1 && model.data.field > 0) flags.field = String(model.data.field);
  if (model.data.step > 0) flags.step = model.data.step;
  Object.assign(flags, colourFlags(model, volume));
  const shown = model.surfaces.filter(x => x.on), isos = shown.map(x => x.iso);
  if (s.isolines && isos.length)
    Object.assign(flags, {iso: isos, colour: lineColour(shown[0].color, coloursAt(isos, flags, model, volume))});
  if (s.nearest) flags.nearest = true;
  return flags;
}

// ---- the panes ----

class Pane {
  constructor(slices, k) {
    this.slices = slices;
    this.k = k;
    this.head = null;
    this.shown = 0;  // the number of the picture that is seen
    this.sent = "";  // what was asked for last,
    this.rest = true; // and whether in full
    const name = k < 3 ? `Slice across ${TITLES[k]}` : "Oblique slice";
    this.canvas = element("canvas", {tabindex: 0, role: "img", "aria-label": `${name}. Arrow keys move it.`});
    this.mark = element("span", {class: "mark", role: "status"});
    this.ways = element("span");
    this.cross = document.createElementNS(NS, "svg");
    this.cross.setAttribute("aria-hidden", "true");
    this.copy = element("button", {class: "icon", "aria-label": `${name}: copy command`,
      title: "Copy the leafcast slice line that draws this picture", onclick: () => this.command()}, "Copy");
    this.bar = element("div");
    this.host = element("figure", {class: "pane", "aria-label": name, hidden: true},
      element("figcaption", {}, element("b", {}, TITLES[k]), this.ways, this.mark, this.copy),
      element("div", {class: "cut"}, this.canvas, this.cross), this.bar);
    this.host.style.setProperty("--pane", COLOURS[k]);
    new ResizeObserver(() => slices.update(false)).observe(this.canvas);
    this.hands();
  }

  get range() {
    const {volume} = this.slices.app, half = diagonal(volume) / 2;
    return this.k < 3 ? [volume.bounds[0][this.k], volume.bounds[1][this.k]] : [-half, half];
  }

  get value() { const {s} = this.slices; return this.k < 3 ? s.at[this.k] : s.offset; }

  move(value, resting) {
    const [low, high] = this.range, x = Math.min(high, Math.max(low, value)), {s, app} = this.slices;
    if (this.k < 3) s.at[this.k] = x;
    else s.offset = x;
    this.field?.set(x);
    app.sliced(!resting);
  }

  step(by, resting) {
    const [low, high] = this.range;
    this.move(this.value + by * (high - low) / STEPS, resting);
  }

  build() {
    const [min, max] = this.range;
    this.field = slider(this.k < 3 ? `${TITLES[this.k]} =` : "offset", {min, max, value: this.value,
      change: (x, resting) => this.move(x, resting)});
    this.bar.replaceChildren(this.field);
  }

  hands() {
    const c = this.canvas;
    c.addEventListener("wheel", event => {
      event.preventDefault();
      this.step(-Math.sign(event.deltaY), false);
    }, {passive: false});
    c.addEventListener("keydown", event => {
      const way = {ArrowUp: 1, ArrowRight: 1, PageUp: 10, ArrowDown: -1, ArrowLeft: -1, PageDown: -10}[event.key];
      if (!way) return;
      event.preventDefault();
      this.step(way, false);
    });
    this.slices.app.pick.hover(c, event => {
      const point = this.point(event);
      return point && {point};
    });
    c.addEventListener("click", event => {
      const point = this.point(event);
      if (!point) return;
      this.slices.centre(point, this.k);
      this.slices.app.pick.at({point});
    });
  }

  // Where an event of the pointer is in the world; null: beside the picture.
  point(event) {
    const h = this.head, box = this.canvas.getBoundingClientRect();
    if (!h) return null;
    const {corner, extent} = this.area;
    const x = (event.clientX - box.left - corner[0]) / extent[0], y = (event.clientY - box.top - corner[1]) / extent[1];
    return x < 0 || x > 1 || y < 0 || y > 1 ? null : add(h.origin, add(scale(h.u, x), scale(h.v, y)));
  }

  // Where the canvas has the picture: its corner and its size.
  get area() {
    const {width: w, height: h} = this.canvas.getBoundingClientRect(), {size} = this.head;
    const fit = Math.min(w / size[0], h / size[1]), extent = size.map(x => x * fit);
    return {corner: [(w - extent[0]) / 2, (h - extent[1]) / 2], extent};
  }

  // Where the other slices across axes cut this one.
  lines() {
    const {s} = this.slices, h = this.head, lines = [];
    for (let a = 0; a < 3 && h && this.k < 3; a++) {
      if (a === this.k || !s.on[a]) continue;
      const {corner, extent} = this.area, along = Math.abs(h.u[a]) > Math.abs(h.v[a]) ? 0 : 1;
      const share = (s.at[a] - h.origin[a]) / (along ? h.v : h.u)[a], at = corner[along] + share * extent[along];
      const from = corner[1 - along], to = from + extent[1 - along], line = document.createElementNS(NS, "line");
      const ends = along ? {x1: from, x2: to, y1: at, y2: at} : {x1: at, x2: at, y1: from, y2: to};
      for (const [key, x] of Object.entries({...ends, stroke: COLOURS[a]})) line.setAttribute(key, x);
      lines.push(line);
    }
    this.cross.replaceChildren(...lines);
  }

  // Pixels that the picture may have.
  get box() {
    const ratio = window.devicePixelRatio || 1, {clientWidth: w, clientHeight: h} = this.canvas;
    const most = Math.min(ratio, Math.sqrt(PIXELS_MAX / (w * h || 1)));
    return [w, h].map(x => Math.min(SIDE_MAX, Math.max(1, Math.floor(x * most))));
  }

  get flags() { return sliceFlags(this.slices.app.model, this.slices.app.volume, this.k); }

  // Asked for, if it is another than before, or in full after it has moved.
  want(moving) {
    if (this.host.hidden || !this.canvas.clientWidth) return;
    const [width, height] = this.box, state = this.flags, key = JSON.stringify([state, width, height]);
    if (key === this.sent && (moving || this.rest)) return;
    this.sent = key;
    this.rest = !moving;
    this.slices.app.link.slice(this.k, {state, width, height, moving});
  }

  show(head, bitmap) {
    this.head = head;
    this.shown = head.slice;
    const c = this.canvas;
    if (c.width !== head.width || c.height !== head.height) Object.assign(c, {width: head.width, height: head.height});
    const to = c.getContext("2d");
    to.globalCompositeOperation = "copy";
    to.drawImage(bitmap, 0, 0);
    bitmap.close();
    this.ways.textContent = `${way(head.u)} → ${way(scale(head.v, -1))} ↑`;
    this.mark.className = head.exact ? "mark exact" : "mark";
    this.mark.textContent = head.exact ? "exact" : "preview";
    this.lines();
  }

  command() {
    const {app} = this.slices, size = this.head?.size;
    if (size) app.copy(command(this.flags, app.volume.path, size[0], size[1], "slice"), "The command is copied.");
  }
}

// The axis that a direction is along most: x, or −x.
function way(v) {
  const a = v.map(Math.abs), k = a.indexOf(Math.max(...a));
  return `${v[k] < 0 ? "−" : ""}${NAMES[k]}`;
}

// ---- all of them ----

export class Slices {
  constructor(app) {
    this.app = app;
    this.panes = NAMES.map((_, k) => new Pane(this, k));
    byId("slices").append(...this.panes.map(p => p.host));
    byId("slices-toggle").addEventListener("click", () => this.toggle());
    app.link.addEventListener("slice", ({detail: {head, bitmap}}) => this.panes[head.pane]?.show(head, bitmap));
    app.link.addEventListener("open", () => { for (const p of this.panes) p.sent = ""; });
  }

  get s() { return this.app.model.slices; }

  toggle() {
    if (!this.app.model) return;
    if (this.s.on.some(Boolean)) return this.hide();
    this.s.on = [true, true, true, false];
    this.build();
    this.app.sliced(false);
  }

  hide() {
    this.s.on = [false, false, false, false];
    this.build();
    this.app.sliced(false);
  }

  // The panes move to where a point is; but for one.
  centre(point, but) {
    const {s, app} = this;
    for (let a = 0; a < 3; a++) if (a !== but) this.panes[a].field?.set(s.at[a] = point[a]);
    if (but !== 3) {
      s.offset = dot(normal(s), sub(point, centre(app.volume)));
      this.panes[3].field?.set(s.offset);
    }
    app.sliced(false);
  }

  build() {
    const {s, app} = this, maps = Object.keys(app.volume.colour_maps), f = app.volume.fields[app.model.data.field];
    this.panes.forEach((p, k) => {
      p.host.hidden = !s.on[k];
      if (s.on[k]) p.build();
    });
    const count = s.on.filter(Boolean).length;
    byId("slices").hidden = count === 0;
    byId("slices").style.setProperty("--panes", count);
    byId("slices-toggle").setAttribute("aria-pressed", count > 0);
    const change = moving => app.sliced(moving);
    const parts = TITLES.map((title, k) => check(k < 3 ? `Across ${title}` : "Oblique", {value: s.on[k], change: on => {
      s.on[k] = on;
      this.build();
      byId("slices-panel").querySelectorAll("input")[k].focus();
      app.sliced(false);
    }}));
    if (s.on[3]) parts.push(...this.oblique());
    parts.push(
      choice("Colours", {options: [["", "grey"], [AS_VOLUME, "the volume's"],
        ...maps.filter(m => m !== "grey").map(m => [m, m])], value: s.map === "grey" ? "" : s.map,
        change: m => { s.map = m; this.build(); app.sliced(false); }}));
    if (!asVolume(app.model)) parts.push(...this.windowing(f));
    parts.push(check("Lines of the isovalues", {value: s.isolines, change: on => { s.isolines = on; change(false); }}),
      check("Nearest samples, not interpolated", {value: s.nearest, change: on => { s.nearest = on; change(false); }}),
      element("p", {class: "hint"}, "The wheel moves a slice; a click in one moves the others there, and tells the value."));
    byId("slices-panel").replaceChildren(...parts);
  }

  // From and to, and the same as level and width, as they are said of CT and MR.
  windowing(f) {
    const {s, app} = this, [min, max] = f.data, shown = () => sliceWindow(app.model, f) ?? f.data;
    const set = (w, rest, row) => {
      s.window = w[1] > w[0] ? w : null;
      for (const r of rows) if (r !== row) r.tell();
      app.sliced(!rest);
    };
    const ends = span("Window", {min, max, value: shown(), change: (w, rest) => set(w, rest, ends)});
    const level = slider("Level", {min, max, value: 0, change: (x, rest) => {
      const half = (shown()[1] - shown()[0]) / 2;
      set([x - half, x + half], rest, level);
    }});
    const width = slider("Width", {min: 0, max: max - min, value: 0, change: (x, rest) => {
      const middle = (shown()[0] + shown()[1]) / 2;
      set([middle - x / 2, middle + x / 2], rest, width);
    }});
    ends.tell = () => ends.set(shown());
    level.tell = () => level.set((shown()[0] + shown()[1]) / 2);
    width.tell = () => width.set(shown()[1] - shown()[0]);
    const rows = [ends, level, width];
    for (const r of rows) r.tell();
    return rows;
  }

  oblique() {
    const {s, app} = this, set = (key, x, rest) => { s[key] = x; app.sliced(!rest); };
    this.angles = {
      azimuth: slider("Azimuth", {min: -180, max: 180, step: 1, value: s.azimuth, change: (x, r) => set("azimuth", x, r)}),
      elevation: slider("Elevation", {min: -90, max: 90, step: 1, value: s.elevation, change: (x, r) => set("elevation", x, r)}),
    };
    return [this.angles.azimuth, this.angles.elevation, element("div", {class: "row"},
      element("button", {onclick: () => this.face()}, "Facing me"))];
  }

  // The oblique slice is seen as the picture is.
  face() {
    const {s, app} = this, c = app.model.camera, n = unit(sub(c.eye, c.lookAt));
    s.azimuth = +(Math.atan2(n[1], n[0]) * 180 / Math.PI).toFixed(2);
    s.elevation = +(Math.asin(Math.max(-1, Math.min(1, n[2]))) * 180 / Math.PI).toFixed(2);
    for (const [key, field] of Object.entries(this.angles)) field.set(s[key]);
    app.sliced(false);
  }

  // ---- what changes ----

  update(moving) {
    if (!this.app.model) return;
    for (const p of this.panes) {
      p.want(moving);
      p.lines();
    }
    this.outline();
  }

  // Where the planes cut the volume's box, in the picture.
  outline() {
    const svg = byId("outlines"), {clientWidth: w, clientHeight: h} = byId("stage"), {s, app} = this, shapes = [];
    for (const p of this.panes) {
      if (!s.on[p.k]) continue;
      const n = p.k < 3 ? [0, 1, 2].map(a => a === p.k ? 1 : 0) : normal(s);
      const d = p.k < 3 ? s.at[p.k] : dot(n, centre(app.volume)) + s.offset;
      const points = cut(app.volume.bounds, n, d).map(q => project(app.model.camera, app.placed(q), w / h));
      if (points.length < 3 || points.some(q => !q)) continue;
      const shape = document.createElementNS(NS, "polygon");
      shape.setAttribute("points", points.map(q => `${(q[0] * w).toFixed(1)},${(q[1] * h).toFixed(1)}`).join(" "));
      shape.setAttribute("stroke", COLOURS[p.k]);
      shapes.push(shape);
    }
    svg.replaceChildren(...shapes);
  }
}

// The corners of where a plane n . p = d cuts a box, in their order around.
function cut(bounds, n, d) {
  const corner = i => [0, 1, 2].map(a => bounds[i >> a & 1][a]), found = [];
  for (let i = 0; i < 8; i++)
    for (let a = 0; a < 3; a++) {
      if (i >> a & 1) continue;
      const p = corner(i), q = corner(i | 1 << a), from = dot(n, p) - d, to = dot(n, q) - d;
      if (from === to || Math.min(from, to) > 0 || Math.max(from, to) < 0) continue;
      found.push(add(p, scale(sub(q, p), from / (from - to))));
    }
  if (!found.length) return [];
  const middle = scale(found.reduce(add), 1 / found.length);
  const right = unit(cross(n, Math.abs(n[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0])), up = cross(n, right);
  const angle = p => Math.atan2(dot(sub(p, middle), up), dot(sub(p, middle), right));
  return found.sort((p, q) => angle(p) - angle(q));
}
