// clip.js - a box and planes that cut the volume, and what closes the cuts.
import {byId, check, choice, element, slider, span} from "./dom.js";
import {PLANES_MAX, centre, diagonal} from "./state.js";
import {frame} from "./camera.js";
import {dot} from "./vector.js";

export class Clip {
  constructor(app) { this.app = app; }

  build() {
    const {app} = this, {clip} = app.model, [low, high] = app.world.bounds;
    const axes = ["X", "Y", "Z"].map((name, a) => {
      const box = () => clip.box ?? [...low, ...high];
      return span(name, {min: low[a], max: high[a], value: [box()[a], box()[a + 3]], change: (v, resting) => {
        const b = [...box()];
        [b[a], b[a + 3]] = v;
        clip.box = b.every((x, i) => x === [...low, ...high][i]) ? null : b;
        app.changed(!resting);
      }});
    });
    const caps = [["off", "open"], ["", "as the surface"],
      ...Object.keys(app.volume.colour_maps).map(m => [m, `values in ${m}`])];
    byId("clip").replaceChildren(...axes, ...clip.planes.map((p, i) => this.plane(p, i)),
      element("div", {class: "row"},
        element("button", {onclick: () => this.add(), ...(clip.planes.length >= PLANES_MAX ? {disabled: true} : {})},
          "Add a plane facing me"),
        element("button", {onclick: () => {
          Object.assign(clip, {box: null, planes: []});
          this.build();
          app.changed(false);
        }}, "No clips")),
      choice("Cuts", {options: caps, value: clip.caps, change: v => { clip.caps = v; app.changed(false); }}));
  }

  // What is behind the plane through the middle of the picture, from here, stays.
  add() {
    const {app} = this, c = app.model.camera, normal = frame(c).back.map(x => +(-x).toFixed(4));
    app.model.clip.planes.push({plane: [...normal, -dot(normal, c.lookAt)], on: true});
    this.build();
    app.changed(false);
  }

  plane(p, i) {
    const {app} = this, normal = p.plane.slice(0, 3), name = `Plane ${i + 1}`;
    const at = dot(normal, centre(app.world)), size = Math.hypot(...normal) * diagonal(app.world) / 2;
    const set = d => { p.plane = [...p.plane.slice(0, 3), d]; };
    return element("div", {role: "group", "aria-label": name},
      slider(name, {min: -at - size, max: -at + size, value: p.plane[3],
        change: (d, resting) => { set(d); app.changed(!resting); }}),
      element("div", {class: "row"},
        check("on", {value: p.on, change: on => { p.on = on; app.changed(false); }}),
        element("button", {onclick: () => { p.plane = p.plane.map(x => -x || 0); this.build(); app.changed(false); },
          "aria-label": `${name}: other side`}, "Other side"),
        element("button", {class: "icon", "aria-label": `Remove ${name.toLowerCase()}`, title: "Remove",
          onclick: () => { app.model.clip.planes.splice(i, 1); this.build(); app.changed(false); }}, "×")));
  }
}
