// data.js - which file, field and time step is shown; steps play one after another, none left out.
import {words} from "./annotate.js";
import {byId, bytes, check, choice, element, short, slider} from "./dom.js";
import {UNIT_MAX, valueUnit} from "./state.js";
import {ABSENT, HERE, NOTHING, SEEN, mix} from "./treelets.js";

export class Data {
  constructor(app) {
    this.app = app;
    this.playing = false;
    this.speed = 5;
    this.end = "loop"; // what comes behind the last step: "loop", "once", "to and fro"
    this.way = 1; // -1: backwards, of "to and fro"
    this.follow = false; // show each step that comes
    this.waiting = null; // the number of the view whose picture the next step waits for
  }

  build() {
    const {app} = this, v = app.volume, d = app.model.data, parts = [];
    this.stop();
    if (v.files?.length > 1 && !v.scene)
      parts.push(choice("File", {options: v.files.map((f, i) => [i, f]), value: v.which,
        change: i => app.open(+i)}));
    if (v.fields.length > 1)
      parts.push(choice("Field", {options: v.fields.map((f, i) => [i, f.name || `field ${i}`]), value: d.field,
        change: i => app.chooseField(+i)}));
    if (v.steps.length > 1) parts.push(...this.steps(v, d));
    const f = v.fields[d.field];
    if (!v.surface) parts.push(words("Unit of values", {value: valueUnit(f, app.model), max: UNIT_MAX, change: unit => {
      app.model.units[f.name] = unit;
      for (const part of [app.surfaces, app.media]) part.build();
      app.pick.show();
      app.changed(false);
    }}));
    parts.push(this.list = this.facts(v));
    byId("data").replaceChildren(...parts);
    app.honesty.ask();
    if (parts.length > 1 && !this.unfolded) byId("sec-data").open = this.unfolded = true;
  }

  steps(v, d) {
    this.slider = slider("Time step", {min: 0, max: v.steps.length - 1, step: 1, value: d.step,
      change: (k, resting) => { this.stop(); this.go(Math.round(k), !resting); }});
    this.time = element("span", {class: "hint"});
    this.held = element("canvas", {id: "steps-held", role: "img", "aria-label": "Steps in memory: not known yet",
      title: "Steps in memory, as far as this view needs them. Green: all; orange: some; grey: nothing."});
    this.present = element("canvas", {id: "steps-present", role: "img", hidden: true,
      title: "Steps where the surfaces' isovalues are, as far as the file's directory tells: white. Dark: nowhere in that step."});
    this.slider.append(this.present, this.held);
    this.button = element("button", {id: "play", "aria-pressed": "false", onclick: () => this.playing ? this.stop() : this.play()},
      "Play");
    const step = by => () => { this.stop(); this.go((d.step + by + v.steps.length) % v.steps.length, false); };
    this.say();
    return [this.slider,
      element("div", {class: "row"},
        element("button", {class: "icon", "aria-label": "Step before", onclick: step(-1)}, "‹"), this.button,
        element("button", {class: "icon", "aria-label": "Step after", onclick: step(1)}, "›"), this.time),
      check("Follow: show each new step", {value: this.follow, change: on => { this.follow = on; if (on) this.newest(); }}),
      choice("At the end", {options: ["loop", "once", "to and fro"].map(e => [e, e]), value: this.end,
        change: e => { this.end = e; this.way = 1; }}),
      slider("Steps a second", {min: 0.5, max: 30, step: 0.5, value: this.speed, change: x => { this.speed = x; }})];
  }

  say() { this.time.textContent = `time ${short(this.app.volume.steps[this.app.model.data.step], 5)}`; }

  go(step, moving) {
    this.app.model.data.step = step;
    this.slider.set(step);
    this.say();
    const number = this.app.changed(moving, this.playing);
    this.app.stepped();
    return number;
  }

  // How much of each step is in memory, as the view needs it: none is wanted of one where nothing is to be seen.
  hold({wanted, resident}) {
    if (!this.held?.isConnected) return;
    this.shares = wanted.map((n, k) => n ? resident[k] / n : 1);
    this.held.width = wanted.length;
    this.held.height = 1;
    const context = this.held.getContext("2d"), whole = this.shares.filter(s => s === 1).length;
    this.shares.forEach((s, k) => {
      context.fillStyle = s === 1 ? mix(HERE) : mix(NOTHING, ABSENT, s && 0.4 + 0.6 * s);
      context.fillRect(k, 0, 1, 1);
    });
    this.held.setAttribute("aria-label", `Steps in memory: ${whole} of ${wanted.length} as a whole, ` +
      `${this.shares.filter(s => s > 0 && s < 1).length} in part`);
  }

  // The steps that have any of the isovalues, in runs; null: there are none to mark.
  mark({steps, at}) {
    if (!this.present?.isConnected) return;
    this.present.hidden = !at;
    this.marked = at;
    if (!at) return;
    this.present.width = steps;
    this.present.height = 1;
    const context = this.present.getContext("2d"), count = at.reduce((sum, [from, to]) => sum + to - from + 1, 0);
    context.fillStyle = mix(NOTHING);
    context.fillRect(0, 0, steps, 1);
    context.fillStyle = SEEN;
    for (const [from, to] of at) context.fillRect(from, 0, to - from + 1, 1);
    this.present.setAttribute("aria-label", `Isovalues: in ${count} of ${steps} steps${count ? `, first in step ${at[0][0]}` : ""}`);
  }

  newest() {
    this.stop();
    this.go(this.app.volume.steps.length - 1, false);
  }

  // There are more steps than there were. What plays goes on.
  grown() {
    const v = this.app.volume;
    if (!this.slider?.isConnected) this.build();
    this.slider.extend(v.steps.length - 1);
    const facts = this.facts(v);
    this.list.replaceWith(facts);
    this.list = facts;
    if (this.follow && !this.playing) this.newest();
  }

  // The step behind this one; null: the last one was shown once.
  following() {
    const last = this.app.volume.steps.length - 1, at = this.app.model.data.step;
    if (this.end === "to and fro" && (this.way > 0 ? at === last : at === 0)) this.way = -this.way;
    if (this.end === "once" && at === last) return null;
    return (at + this.way + last + 1) % (last + 1);
  }

  play() {
    this.playing = true;
    this.button.textContent = "Stop";
    this.button.setAttribute("aria-pressed", "true");
    this.next(this.following() ?? 0);
  }

  stop() {
    if (!this.playing) return;
    this.playing = false;
    this.waiting = null;
    clearTimeout(this.timer);
    this.button.textContent = "Play";
    this.button.setAttribute("aria-pressed", "false");
    this.app.changed(false);
  }

  next(step) {
    this.began = performance.now();
    this.waiting = this.go(step, true);
  }

  // A picture of the step is on the screen: the next one may come.
  shown(head) {
    if (!this.playing || this.waiting == null || head.number < this.waiting) return;
    this.waiting = null;
    const step = this.following();
    if (step == null) this.stop();
    else this.timer = setTimeout(() => this.next(step), Math.max(0, 1000 / this.speed - (performance.now() - this.began)));
  }

  facts(v) {
    const f = v.fields[this.app.model.data.field];
    const lines = [["file", v.file], ["size", bytes(v.file_bytes)],
      ...v.dims[0] ? [["samples", v.dims.join(" × ")]]
        : [[`${v.cell}s`, v.cells.toLocaleString("en")], ["vertices", v.nodes.toLocaleString("en")]],
      f.name ? ["field", f.name] : null, v.steps.length > 1 ? ["time steps", v.steps.length] : null,
      ["type", v.sample_type], ["values", `${short(f.range[0])} … ${short(f.range[1])}`],
      ["from", v.bounds[0].map(x => short(x)).join(", ")], ["to", v.bounds[1].map(x => short(x)).join(", ")],
      v.ends.length ? ["axes", [0, 2, 4].map(k => `${"XYZ"[k >> 1]}: ${v.ends[k + 1]} to ${v.ends[k]}`).join(", ")] : null,
      v.units.some(Boolean) ? ["units", v.units.map(u => u || "?").join(", ")] : null,
      ["treelets", v.treelets.toLocaleString("en")], ["drawn by", `leafcast ${v.version}, ${v.threads} threads, ${v.isa}`]];
    return element("dl", {}, ...lines.filter(Boolean).flatMap(([a, b]) => [element("dt", {}, a), element("dd", {}, String(b))]));
  }
}
