// volume.js - the volume itself: colours and opacities of its values, and projections.
import {byId, check, choice, element, short, slider, span} from "./dom.js";
import {Plot, drag} from "./histogram.js";
import {diagonal, stepOf, valueUnit} from "./state.js";

const MODES = [["off", "not shown"], ["media", "see-through"], ["max", "maximum (MIP)"], ["min", "minimum"],
  ["mean", "mean"], ["first", "first to reach a value"]];
const PRESETS = [["auto", "automatic"], ["ct", "CT"], ["mr", "MR"], ["custom", "own points"]];
const OPACITY_MAX = 0.98; // of a curve's point: at 1 nothing would be let through
const PRESET_MOST = 0.8; // of a preset's points, as they are shown

export class Volume {
  constructor(app) {
    this.app = app;
  }

  get v() { return this.app.model.volume; }
  get field() { return this.app.volume.fields[this.app.model.data.field]; }
  get step() { return stepOf(this.field, this.app.model.data.step); }

  build() {
    const {v, app} = this, maps = Object.keys(app.volume.colour_maps);
    const change = moving => { this.refresh(); app.changed(moving); };
    const host = element("div", {class: "plot"});
    const projected = !["off", "media"].includes(v.mode), media = v.mode === "media";
    const parts = [choice("Show", {options: MODES.slice(0, app.scene.told ? 2 : MODES.length), value: v.mode, change: mode => this.mode(mode)})];
    this.points = [];
    this.plot = null;
    if (v.mode !== "off") parts.push(...this.look(media, projected, maps, host, change));
    byId("volume").replaceChildren(...parts);
    this.refresh();
  }

  look(media, projected, maps, host, change) {
    const {v, app} = this;
    this.gradient = element("canvas", {class: "gradient", "aria-hidden": "true"});
    this.plot = new Plot(host, () => this.colours());
    const options = maps.map(m => [m, m]);
    if (media && v.preset !== "custom") options.unshift(["", "the preset's"]);
    const parts = [];
    if (media) parts.push(choice("Opacity", {options: PRESETS, value: v.preset, change: p => this.preset(p)}));
    parts.push(choice("Colours", {options, value: v.map || (media && v.preset === "custom" ? "viridis" : options[0][0]),
      change: m => { v.map = m; this.build(); app.changed(false); }}), this.gradient, host);
    if (media) parts.push(element("p", {class: "hint"}, v.preset === "custom"
      ? "Drag the points; click the plot to add one, Delete takes one away."
      : "Click the plot to make its points your own, and drag them."));
    if (v.mode === "first")
      parts.push(slider("Value", {min: this.field.data[0], max: this.field.data[1], value: v.first,
        change: (x, rest) => { v.first = x; change(!rest); }}));
    if (projected || v.map || v.preset === "custom")
      parts.push(span("Window", {min: this.field.data[0], max: this.field.data[1],
        value: v.window ?? this.field.data, change: (w, rest) => {
          v.window = w[1] > w[0] ? w : null;
          change(!rest);
        }}));
    if (media && v.preset === "custom")
      parts.push(slider("Density", {min: -2, max: 2, step: 0.01, value: -Math.log10((v.length ?? this.usual) / this.usual),
        change: (x, rest) => { v.length = +(this.usual * 10 ** -x).toPrecision(4); change(!rest); }}));
    parts.push(check("Colour bar in the picture", {value: app.model.legend,
      change: on => { app.model.legend = on; app.changed(false); }}));
    this.plot.show(this.field, this.step, valueUnit(this.field, this.app.model));
    if (media) this.edit(host);
    return parts;
  }

  get usual() { return diagonal(this.app.volume) / 10; }

  // Of this step: its points as opacities over a length at which they are well seen. null: not known.
  get told() {
    const preset = this.step.presets[this.v.preset];
    const most = Math.max(0, ...preset?.points.map(p => p[1]) ?? []);
    if (this.v.mode !== "media" || !(most > 0)) return null;
    const length = -Math.log(1 - PRESET_MOST) / most;
    return {...preset, length, points: preset.points.map(([x, e]) => [x, 1 - Math.exp(-e * length)])};
  }

  // The colours over the values that they are spread over, where the page knows them.
  colours() {
    const {v, told} = this, projected = !["off", "media"].includes(v.mode), own = projected || v.preset === "custom";
    if (!own && !v.map) return told && {colours: told.colours, low: told.points[0][0], high: told.points.at(-1)[0]};
    const [low, high] = v.window ?? this.field.data;
    return {colours: this.app.volume.colour_maps[v.map || (projected ? "grey" : "viridis")], low, high};
  }

  stepped() {
    this.plot?.show(this.field, this.step, valueUnit(this.field, this.app.model));
    this.refresh();
  }

  refresh() {
    if (!this.plot) return;
    this.points = this.v.mode !== "media" ? [] : this.v.preset === "custom" ? this.v.points : this.told?.points ?? [];
    this.plot.curve = this.points.map(([x, a]) => [this.plot.share(x), a]);
    this.plot.draw();
    const found = this.colours(), c = this.gradient.getContext("2d");
    this.gradient.hidden = !found;
    this.gradient.width = 256;
    this.gradient.height = 1;
    for (let x = 0; found && x < 256; x++) {
      const t = (this.plot.value(x / 255) - found.low) / (found.high - found.low || 1);
      c.fillStyle = found.colours[Math.round(Math.min(1, Math.max(0, t)) * (found.colours.length - 1))];
      c.fillRect(x, 0, 1, 1);
    }
    this.dots?.forEach((dot, i) => this.place(dot, i));
  }

  mode(mode) {
    const {v} = this;
    if (mode === "first") v.first ??= this.step.suggested[0] ?? this.plot?.value(0.5) ?? this.field.data[1];
    this.uncover(mode);
    if (mode !== "media") this.giveBack();
    if (mode !== "off") this.app.seeVolume();
    v.mode = mode;
    this.app.surfaces.build();
    this.build();
    this.app.slices.build();
    byId("volume").querySelector("select").focus();
    this.app.changed(false);
  }

  // Opaque surfaces would hide the volume, and projections draw none; without it they are back.
  uncover(mode) {
    for (const s of this.app.model.surfaces) {
      if (s.covered) Object.assign(s, {on: true, covered: false});
      if (s.on && (mode === "media" ? s.opacity === 1 : mode !== "off")) Object.assign(s, {on: false, covered: true});
    }
  }

  preset(preset) {
    if (preset === "custom") this.own();
    else this.giveBack();
    this.v.preset = preset;
    this.build();
    this.app.slices.build();
    byId("volume").querySelectorAll("select")[1].focus();
    this.app.changed(false);
  }

  // Points to begin with: the preset's; else nothing up to the first suggested value, then more.
  own() {
    const {v, told} = this, [low, high] = this.field.data;
    if (v.points.length) return;
    if (told) return this.borrow(told);
    const s = this.step.suggested.find(x => x > low && x < high) ?? (low + high) / 2;
    v.points = [[low, 0], [s - 0.12 * (s - low), 0], [s + 0.25 * (high - s), 0.25], [high, 0.8]];
  }

  // With points at both ends: beyond the outermost, all is as there. The colours of the one that has a map's stay.
  borrow({points, length}) {
    const {v} = this, [low, high] = this.field.data;
    v.points = points.map(([x, a]) => [+x.toPrecision(7), +a.toFixed(3)]);
    if (low < v.points[0][0]) v.points.unshift([low, v.points[0][1]]);
    if (high > v.points.at(-1)[0]) v.points.push([high, v.points.at(-1)[1]]);
    v.length = +length.toPrecision(4);
    if (v.preset === "auto" && !v.map) v.window = this.lent = [points[0][0], points.at(-1)[0]];
  }

  // What a preset lent to own points goes with them.
  giveBack() {
    if (this.lent && this.v.window === this.lent) this.v.window = null;
  }

  // ---- the points ----

  edit(host) {
    const shown = this.v.preset === "custom" ? this.v.points : [];
    this.dots = shown.map((p, i) => this.dot(i));
    host.append(...this.dots);
    host.addEventListener("pointerdown", event => {
      if (event.target.closest(".dot") || event.button !== 0) return;
      event.preventDefault(); // else what it was pressed on, which goes, would lose the focus again
      const first = this.v.preset !== "custom";
      if (first) { this.own(); this.v.preset = "custom"; }
      const [x, y] = this.plot.at(event), value = this.plot.value(x);
      const added = this.bounded(value, y);
      if (!first) this.v.points.push(added);
      this.v.points.sort((a, b) => a[0] - b[0]);
      this.build();
      this.app.changed(false);
      // The hand that has made a point drags it.
      this.dots[this.v.points.indexOf(added)]?.dispatchEvent(new PointerEvent("pointerdown", event));
    });
  }

  bounded(value, a) {
    const step = (this.plot.high - this.plot.low) / 2000;
    return [+(Math.round(value / step) * step).toPrecision(7), +Math.min(OPACITY_MAX, Math.max(0, a)).toFixed(3)];
  }

  dot(i) {
    const dot = element("button", {class: "dot", role: "slider", "aria-label": `Opacity point ${i + 1}`,
      "aria-valuemin": 0, "aria-valuemax": 1, "aria-orientation": "vertical"});
    drag(dot, this.plot, ([x, y], keys, resting) => {
      const p = this.v.points[i], before = this.v.points[i - 1], after = this.v.points[i + 1];
      const value = this.plot.value(keys ? this.plot.share(p[0]) + x : x);
      const q = this.bounded(Math.min(after?.[0] ?? Infinity, Math.max(before?.[0] ?? -Infinity, value)), keys ? p[1] + y : y);
      this.v.points[i] = [Math.min(after?.[0] ?? q[0], Math.max(before?.[0] ?? q[0], q[0])), q[1]];
      this.refresh();
      this.app.changed(!resting);
    });
    dot.addEventListener("keydown", event => {
      if (!["Delete", "Backspace"].includes(event.key) || this.v.points.length <= 2) return;
      event.preventDefault();
      this.v.points.splice(i, 1);
      this.build();
      this.dots[Math.min(i, this.dots.length - 1)].focus();
      this.app.changed(false);
    });
    dot.addEventListener("dblclick", () => dot.dispatchEvent(new KeyboardEvent("keydown", {key: "Delete"})));
    return dot;
  }

  place(dot, i) {
    const p = this.v.points[i];
    if (!p) return;
    dot.style.left = `${100 * Math.min(1, Math.max(0, this.plot.share(p[0])))}%`;
    dot.style.top = this.plot.top(p[1]);
    dot.setAttribute("aria-valuenow", p[1]);
    dot.setAttribute("aria-valuetext", `opacity ${short(p[1], 3)} at ${short(p[0], 5)}`);
  }
}
