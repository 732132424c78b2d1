// surfaces.js - the isosurfaces: a handle each on the histogram, and a line each below it.
import {brief, byId, colour, element, short} from "./dom.js";
import {Plot, drag} from "./histogram.js";
import {COLOURS, SURFACES_MAX, asideOf, isProjected, stepOf, valueUnit} from "./state.js";

const THROUGH = 0.45; // an opacity through which others are seen
const RAYS = 7; // a side: how many tell which surface lies within which

export class Surfaces {
  constructor(app) {
    this.app = app;
    this.plot = new Plot(byId("iso-plot"));
    byId("surface-add").addEventListener("click", () => this.add());
    // A press beside the handles takes the nearest there.
    this.plot.host.addEventListener("pointerdown", event => this.jump(event));
  }

  get field() { return this.app.volume.fields[this.app.model.data.field]; }
  get step() { return stepOf(this.field, this.app.model.data.step); }
  get unit() { return valueUnit(this.field, this.app.model); }
  get list() { return this.app.model.surfaces; }

  build() {
    this.stepped();
    const aside = asideOf(this.field);
    byId("iso-aside").hidden = aside == null;
    byId("iso-aside").textContent = `${short(aside ?? 0, 6)} may stand for no data, and is left aside. `
      + "If it does, convert with --missing.";
    for (const g of this.plot.host.querySelectorAll(".grip")) g.remove();
    this.grips = this.list.map((s, i) => this.grip(s, i));
    this.plot.host.append(...this.grips);
    this.rows = this.list.map((s, i) => this.row(s, i));
    this.nowhere = element("p", {class: "hint", hidden: true});
    if (isProjected(this.app.model.volume) && this.list.length)
      this.rows.push(element("p", {class: "hint"}, "A projection shows no surfaces."));
    byId("surfaces").replaceChildren(this.list.length ? this.head() : element("p", {class: "hint"}, "No surfaces."),
      ...this.rows, this.nowhere);
    byId("surface-add").disabled = this.list.length >= SURFACES_MAX;
    this.list.forEach((s, i) => this.place(i));
  }

  stepped() { this.plot.show(this.field, this.step, this.unit); }

  // A value that a person would write: to a 2000th of the range, and a half for integers' sake.
  rounded(v) {
    const step = 10 ** Math.floor(Math.log10((this.plot.high - this.plot.low) / 400 || 1));
    return +(Math.round(v / step) * step).toPrecision(10);
  }

  set(i, value, resting) {
    this.list[i].iso = this.rounded(value);
    this.place(i);
    this.app.changed(!resting);
  }

  place(i) {
    const s = this.list[i], grip = this.grips[i];
    grip.style.left = `${100 * Math.min(1, Math.max(0, this.plot.share(s.iso)))}%`;
    grip.style.setProperty("--grip", s.color);
    grip.classList.toggle("off", !s.on);
    grip.setAttribute("aria-valuenow", s.iso);
    grip.setAttribute("aria-valuetext", `${short(s.iso, 6)} ${this.unit}`.trim());
    const number = this.rows[i].querySelector(".iso");
    if (document.activeElement !== number) number.value = brief(s.iso);
    number.title = `${s.iso} ${this.unit}`.trim();
    this.tell();
  }

  // A surface has values on both of its sides.
  tell() {
    const [low, high] = this.field.range, none = this.list.filter(t => t.on && !(t.iso > low && t.iso <= high));
    this.nowhere.hidden = !none.length;
    this.nowhere.textContent = `Nothing has a surface at ${none.map(t => short(t.iso, 6)).join(", ")}: `
      + `values are ${short(low, 6)} to ${short(high, 6)}.`;
  }

  head() {
    return element("div", {class: "surface head", "aria-hidden": "true"},
      ...["", "opacity", this.unit ? `value, ${this.unit}` : "isovalue", ""].map(text => element("span", {}, text)));
  }

  grip(s, i) {
    const grip = element("button", {class: "grip", role: "slider", "aria-label": `Isovalue ${i + 1}`,
      "aria-valuemin": this.plot.low, "aria-valuemax": this.plot.high});
    drag(grip, this.plot, ([x], keys, resting) =>
      this.set(i, this.plot.value(keys ? this.plot.share(s.iso) + x : x), resting));
    return grip;
  }

  jump(event) {
    const near = this.list.map((s, i) => i).filter(i => this.list[i].on);
    if (event.target.closest(".grip") || !near.length) return;
    const [x] = this.plot.at(event), away = i => Math.abs(this.plot.share(this.list[i].iso) - x);
    const i = near.sort((a, b) => away(a) - away(b))[0];
    this.set(i, this.plot.value(x), false);
    this.grips[i].dispatchEvent(new PointerEvent("pointerdown", event));
  }

  row(s, i) {
    const name = `Surface ${i + 1}`, {app} = this;
    const on = element("input", {type: "checkbox", "aria-label": `${name} on`, title: "On"});
    on.checked = s.on;
    on.disabled = isProjected(app.model.volume);
    on.addEventListener("change", () => {
      Object.assign(s, {on: on.checked, covered: false});
      this.place(i);
      app.changed(false);
    });
    const iso = element("input", {type: "number", step: "any", class: "iso", "aria-label": `${name} isovalue`});
    iso.addEventListener("change", () => {
      if (iso.value !== "" && Number.isFinite(+iso.value)) s.iso = +iso.value;
      this.place(i);
      app.changed(false);
    });
    iso.addEventListener("focus", () => { iso.value = s.iso; });
    iso.addEventListener("blur", () => { iso.value = brief(s.iso); });
    const opacity = element("input", {type: "range", min: 0.05, max: 1, step: 0.01, value: s.opacity,
      "aria-label": `${name} opacity`, title: "Opacity"});
    opacity.addEventListener("input", () => { s.opacity = +opacity.value; app.changed(true); });
    opacity.addEventListener("change", () => app.changed(false));
    const away = element("button", {class: "icon", "aria-label": `Remove ${name.toLowerCase()}`, title: "Remove",
      onclick: () => { this.list.splice(i, 1); this.build(); app.changed(false); byId("surface-add").focus(); }}, "×");
    return element("div", {class: "surface"}, on,
      colour(`${name} colour`, {value: s.color, change: (v, rest) => { s.color = v; this.place(i); app.changed(!rest); }}),
      opacity, iso, away);
  }

  // The first suggested value that is not drawn yet, else the middle of the widest gap.
  add() {
    const taken = this.list.map(s => s.iso), range = this.plot.high - this.plot.low;
    let iso = this.step.suggested.find(v => taken.every(t => Math.abs(t - v) > range / 200));
    if (iso == null) {
      const all = [this.plot.low, ...taken, this.plot.high].sort((a, b) => a - b);
      let k = 1;
      for (let j = 1; j < all.length; j++) if (all[j] - all[j - 1] > all[k] - all[k - 1]) k = j;
      iso = this.rounded((all[k] + all[k - 1]) / 2);
    }
    // What is there already lets the new one be seen, until it is known which lies within which.
    const used = this.list.map(s => s.color), color = COLOURS.find(c => !used.includes(c)) ?? COLOURS[0];
    for (const s of this.list) if (s.opacity === 1) s.opacity = THROUGH;
    this.list.push({iso, color, opacity: 1, on: true});
    this.build();
    this.app.changed(false);
    this.uncover();
  }

  // The surface that rays from here meet least lies within the others: it alone is opaque. Opacities that a hand has
  // set stay.
  async uncover() {
    const {app, list} = this, {width, height} = app.screen, on = list.filter(s => s.on), met = on.map(() => 0);
    const place = k => (k + 0.5) / RAYS;
    for (let y = 0; y < RAYS; y++) {
      const row = Array.from({length: RAYS}, (_, x) => app.link.pick({x: place(x) * width, y: place(y) * height}));
      for (const hit of await Promise.all(row))
        if (hit?.hit && (hit.object ?? app.volume.which) === app.volume.which && hit.surface in met) met[hit.surface]++;
    }
    const ours = on.map((s, i) => i).filter(i => [1, THROUGH].includes(on[i].opacity));
    const same = app.model && this.list === list && on.every(s => list.includes(s) && s.on);
    if (!same || ours.length < 2 || !met.some(Boolean)) return;
    const inner = ours.reduce((a, b) => met[b] < met[a] || (met[b] === met[a] && on[a].opacity < 1) ? b : a);
    if (on[inner].opacity === 1) return;
    for (const i of ours) on[i].opacity = i === inner ? 1 : THROUGH;
    this.build();
    app.changed(false);
  }
}
