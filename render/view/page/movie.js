// movie.js - keyframes and turntables: kept, played, saved as JSON; `leafcast render` draws them.
import {byId, element, slider} from "./dom.js";
import {download} from "./save.js";
import {command, freeStem, toFlags} from "./state.js";
import {add, cross, dot, length, scale, sub, turn, unit} from "./vector.js";

const KEYS_MAX = 100;
const EVEN = ["iso", "opacity", "colour", "fov", "ortho", "window", "ambient", "specular", "shininess", "clip-plane",
  "light", "clip-box", "point-light", "error", "step", "background", "opacity-length"];

// ---- what is between two keys: as render/app/keyframes.c has it ----

const even = (a, b, t) => a === b ? a : a + t * (b - a);

function texts(a, b, t) {
  if (a[0] === "#" && b[0] === "#" && a.length === b.length && a.length % 2)
    return "#" + a.slice(1).match(/../g).map((d, i) => Math.round(even(parseInt(d, 16),
      parseInt(b.slice(1 + 2 * i, 3 + 2 * i), 16), t)).toString(16).padStart(2, "0")).join("");
  const number = /[0-9.+eE-]+/g, to = b.match(number) ?? [];
  if (/[^0-9.+eE:, -]/.test(a) || a.replace(number, "") !== b.replace(number, "") || a.match(number)?.length !== to.length)
    return a;
  let i = 0;
  return a.replace(number, x => String(even(+x, +to[i++], t)));
}

function values(a, b, t) {
  if (typeof a === "number" && typeof b === "number") return even(a, b, t);
  if (typeof a === "string" && typeof b === "string") return texts(a, b, t);
  if (!Array.isArray(a) || !Array.isArray(b) || a.length !== b.length) return a;
  return a.map((x, i) => values(x, b[i], t));
}

// From unit vector a towards b, on the great circle.
function towards(a, b, t) {
  let axis = cross(a, b);
  const angle = t * Math.atan2(length(axis), dot(a, b));
  if (length(axis) < 1e-12) axis = cross(a, Math.abs(a[0]) < 0.6 ? [1, 0, 0] : [0, 1, 0]);
  return turn(a, unit(axis), angle);
}

function poseOf(key) {
  const away = sub(key.eye, key["look-at"]);
  return {at: key["look-at"], away: unit(away), up: unit(key.up), far: Math.log(length(away))};
}

const poses = (a, b, t) => ({at: a.at.map((x, i) => even(x, b.at[i], t)), away: towards(a.away, b.away, t),
  up: towards(a.up, b.up, t), far: even(a.far, b.far, t)});

export function frame(keys, at) {
  const last = keys.length - 1, k = Math.min(last, Math.floor(at)), t = at - k;
  if (t === 0) return keys[k];
  const out = {...keys[k]};
  for (const key of EVEN)
    if (key in out && key in keys[k + 1]) out[key] = values(out[key], keys[k + 1][key], t);
  if ("step" in out) out.step = Math.floor(out.step);
  const p = [k - 1, k, k + 1, k + 2].map(i => poseOf(keys[Math.max(0, Math.min(last, i))]));
  const a = poses(p[0], p[1], t + 1), b = poses(p[1], p[2], t), c = poses(p[2], p[3], t - 1);
  const now = poses(poses(a, b, (t + 1) / 2), poses(b, c, t / 2), t);
  return {...out, "look-at": now.at, up: now.up, eye: add(now.at, scale(now.away, Math.exp(now.far)))};
}

// A share of a whole turn about what is up.
export function turned(flags, share) {
  const away = turn(sub(flags.eye, flags["look-at"]), unit(flags.up), 2 * Math.PI * share);
  return {...flags, eye: add(flags["look-at"], away)};
}

export class Movie {
  constructor(app) {
    this.app = app;
    this.keys = [];
    this.frames = 120;
    this.play = null; // {view(i), i, waiting, back}
  }

  // Steps that are not said are the first one: a key says its own.
  key() {
    const {app} = this, flags = toFlags(app.model, app.volume);
    return app.volume.steps.length > 1 ? {step: 0, ...flags} : flags;
  }

  build() {
    const list = this.keys.map((key, i) => element("div", {class: "row"}, `Key ${i + 1}`,
      element("button", {"aria-label": `Show key ${i + 1}`, onclick: () => { this.stop(); this.app.adopt(key); }}, "Show"),
      element("button", {"aria-label": `Replace key ${i + 1}`, onclick: () => { this.keys[i] = this.key(); this.build(); }},
        "Replace"),
      element("button", {class: "icon", "aria-label": `Remove key ${i + 1}`,
        onclick: () => { this.stop(); this.keys.splice(i, 1); this.build(); }}, "×")));
    const few = this.keys.length < 2, playing = Boolean(this.play);
    byId("movie").replaceChildren(
      slider("Pictures", {min: 2, max: 1000, step: 1, value: this.frames, change: n => { this.frames = Math.round(n); }}),
      element("div", {class: "row"},
        element("button", {disabled: this.keys.length >= KEYS_MAX, id: "key-add",
          onclick: () => { this.keys.push(this.key()); this.build(); byId("key-add").focus(); }}, "Add a key"),
        element("button", {id: "movie-play", disabled: few && !playing, "aria-pressed": String(playing),
          onclick: () => playing ? this.stop() : this.start(false)}, playing ? "Stop" : "Play"),
        element("button", {id: "movie-turn", disabled: playing, onclick: () => this.start(true)}, "Turn about")),
      ...list,
      element("div", {class: "row"},
        element("button", {id: "movie-save", disabled: few, onclick: () => this.save()}, "Save keys (JSON)"),
        element("button", {id: "movie-command", disabled: few, onclick: () => this.command(false)}, "Copy command"),
        element("button", {id: "turn-command", onclick: () => this.command(true)}, "Copy turntable's command")),
      element("p", {class: "hint"}, "leafcast render draws movies: numbered pictures, or with -o - into an encoder."));
  }

  start(turning) {
    const here = this.key();
    const view = turning ? i => turned(here, i / this.frames)
      : i => frame(this.keys, i * (this.keys.length - 1) / (this.frames - 1));
    this.play = {view, i: 0, waiting: null, back: turning ? this.app.model : null};
    this.build();
    this.next();
  }

  next() {
    const p = this.play;
    if (!p) return;
    if (p.i >= this.frames) return this.stop();
    p.waiting = this.app.film(p.view(p.i++));
  }

  // A picture is on the screen: the next one may come.
  shown(head) {
    if (!this.play || this.play.waiting == null || head.number < this.play.waiting) return;
    this.play.waiting = null;
    setTimeout(() => this.next(), 20);
  }

  stop() {
    const p = this.play;
    if (!p) return;
    this.play = null;
    if (p.back) Object.assign(this.app, {model: p.back});
    this.app.build();
    this.app.changed(false);
    byId("movie-turn").focus();
  }

  save() {
    download(new Blob([JSON.stringify(this.keys, null, 1) + "\n"], {type: "application/json"}), `${this.app.save.name}-keys.json`);
  }

  command(turning) {
    const {app} = this, {name} = app.save;
    const line = command(turning ? toFlags(app.model, app.volume) : {}, app.volume.path, app.screen.width, app.screen.height, "render", null);
    const more = turning ? `--turntable=${this.frames}` : `--camera-path=${name}-keys.json --frames=${this.frames}`;
    app.copy(`${line} ${more} -o ${freeStem(name)}_%04d.png --force`, "The command is copied.");
  }
}
