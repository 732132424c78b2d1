// light.js - lights, shadows, how surfaces shine, and what is behind them.
import {byId, check, choice, colour, element, slider} from "./dom.js";
import {LIGHTS_MAX} from "./state.js";
import {frame} from "./camera.js";
import {add, scale, unit} from "./vector.js";

export class Light {
  constructor(app) { this.app = app; }

  build() {
    const {app} = this, l = app.model.light;
    const set = (key, resting = true) => v => { l[key] = v; app.changed(!resting); };
    const again = key => v => { l[key] = v; this.build(); app.changed(false); };
    const ground = colour("Background colour", {value: l.background ?? "#20262f",
      change: (v, resting) => { l.background = v; l.clear = false; app.changed(!resting); }});
    const smooth = app.volume.gradients || l.normals === "smooth" ? [["smooth", "smooth"]] : [];
    const normals = app.volume.analytic_normals
      ? [["", "central differences"], ["analytic", "of the cell"]] : [["", "faceted"], ...smooth];
    const parts = [...l.lights.map((light, i) => this.light(light, i)),
      l.lights.length ? null : element("p", {class: "hint"}, "A light shines from the eye."),
      element("div", {class: "row"},
        element("button", {onclick: () => this.add(), ...(l.lights.length >= LIGHTS_MAX ? {disabled: true} : {})},
          "Add a light")),
      l.lights.length ? check("Shadows", {value: l.shadows, change: set("shadows")}) : null,
      slider("Ambient", {min: 0, max: 1, step: 0.01, value: l.ambient,
        change: (v, resting) => { l.ambient = v; app.changed(!resting); }}),
      choice("Shading", {options: [["diffuse", "diffuse"], ["phong", "glossy (Phong)"], ["flat", "flat"]],
        value: l.shading, change: again("shading")})];
    if (l.shading === "phong") for (const [key, label, max] of [["specular", "Highlight", 1], ["shininess", "Shininess", 256]])
      parts.push(slider(label, {min: key === "specular" ? 0 : 1, max, step: max / 256, value: l[key],
        change: (v, resting) => { l[key] = v; app.changed(!resting); }}));
    parts.push(choice("Normals", {options: normals, value: l.normals === "central" || l.normals === "faceted" ? "" : l.normals,
      change: set("normals")}),
      choice("Smooth edges", {options: [[1, "off"], [4, "4 rays a pixel"], [16, "16 rays a pixel"]], value: l.samples,
        change: v => set("samples")(+v)}),
      element("div", {class: "field"}, element("span", {}, "Background"),
        element("span", {class: "row"}, ground, check("clear", {value: l.clear, change: set("clear")}))));
    byId("light").replaceChildren(...parts.filter(Boolean));
  }

  // From above and left of the eye.
  add() {
    const {app} = this, f = frame(app.model.camera);
    const u = unit(add(add(f.back, scale(f.right, -0.7)), scale(f.up, 0.8)));
    app.model.light.lights.push({point: null, exact: null, colour: "#ffffff",
      azimuth: Math.round(Math.atan2(u[1], u[0]) * 180 / Math.PI), elevation: Math.round(Math.asin(u[2]) * 180 / Math.PI)});
    this.build();
    app.changed(false);
  }

  light(light, i) {
    const {app} = this, name = `Light ${i + 1}`;
    const angle = (key, label, reach) => slider(`${label} ${i + 1}`, {min: -reach, max: reach, step: 1,
      value: Math.round(light[key]), change: (v, resting) => {
        light[key] = v;
        light.exact = null;
        app.changed(!resting);
      }});
    return element("div", {role: "group", "aria-label": name},
      element("div", {class: "row"},
        colour(`${name} colour`, {value: light.colour, change: (v, rest) => { light.colour = v; app.changed(!rest); }}),
        element("span", {}, light.point ? `${name} at ${light.point.map(x => +x.toPrecision(4)).join(", ")}` : name),
        element("button", {class: "icon", "aria-label": `Remove ${name.toLowerCase()}`, title: "Remove", onclick: () => {
          app.model.light.lights.splice(i, 1);
          this.build();
          app.changed(false);
        }}, "×")),
      ...(light.point ? [] : [angle("azimuth", "Azimuth", 180), angle("elevation", "Elevation", 90)]));
  }
}
