// annotate.js - what tells the picture's reader where he is: box, axes, scale bar, title. The server draws them.
import {project} from "./camera.js";
import {byId, check, element} from "./dom.js";

const PARTS = [["box", "Bounding box"], ["axes", "Axes with values"], ["scale", "Scale bar"]];
const TEXT_MAX = 60, UNIT_MAX = 7; // letters; render takes as many bytes as these may have

// ---- flags ----

export function annotationOf(flags) {
  const given = flags.annotate, names = given === true ? PARTS.map(p => p[0])
    : (Array.isArray(given) ? given.map(String) : String(given || "").split(","));
  return {...Object.fromEntries(PARTS.map(([name]) => [name, names.includes(name)])),
    title: String(flags.title ?? ""), unit: String(flags.unit ?? "")};
}

export function annotationFlags(a) {
  const names = PARTS.map(p => p[0]).filter(name => a[name]), flags = {};
  if (names.length) flags.annotate = names.length === PARTS.length ? true : names.join(",");
  if (a.title) flags.title = a.title;
  if (a.unit && names.length) flags.unit = a.unit;
  return flags;
}

// ---- the panel ----

export function words(label, {value, max, change}) {
  const input = element("input", {type: "text", maxlength: max, "aria-label": label, value});
  input.addEventListener("change", () => change(input.value.trim()));
  return element("div", {class: "field"}, element("span", {}, label), input);
}

export class Annotate {
  constructor(app) { this.app = app; }

  build() {
    const {app} = this, a = app.model.annotation;
    const set = (key, value) => {
      a[key] = value;
      if (key === "axes" && value && !a.box) { a.box = true; this.build(); } // values along nothing float
      if (value && ["box", "axes"].includes(key)) app.seeVolume();
      app.changed(false);
    };
    byId("annotate").replaceChildren(
      ...PARTS.map(([name, label]) => check(label, {value: a[name], change: on => set(name, on)})),
      words("Title", {value: a.title, max: TEXT_MAX, change: text => set("title", text)}),
      words("Unit of length", {value: a.unit, max: UNIT_MAX, change: text => set("unit", text)}),
      element("p", {class: "hint"}, "Text is drawn when the hand rests, and saved with the picture."));
  }

  // Words beside the box are in the picture, too.
  get margin() {
    const a = this.app.model.annotation;
    return a.axes ? 1.35 : a.title || a.scale ? 1.15 : 1.04;
  }

  // The server draws the box when the hand rests; until then its edges are drawn here.
  outline(moving) {
    const {app} = this, {clientWidth: w, clientHeight: h} = byId("stage"), lines = [];
    const bounds = app.scene.told ? app.scene.firstShown.box : app.volume.bounds;
    const corner = i => project(app.model.camera, [0, 1, 2].map(a => bounds[i >> a & 1][a]), w / h);
    for (let i = 0; i < 8 && moving && app.model.annotation.box; i++)
      for (const j of [i | 1, i | 2, i | 4].filter(k => k !== i)) {
        const [from, to] = [corner(i), corner(j)];
        if (!from || !to) continue;
        const line = document.createElementNS("http://www.w3.org/2000/svg", "line");
        for (const [k, v] of Object.entries({x1: from[0] * w, y1: from[1] * h, x2: to[0] * w, y2: to[1] * h}))
          line.setAttribute(k, v);
        lines.push(line);
      }
    byId("edges").replaceChildren(...lines);
  }
}
