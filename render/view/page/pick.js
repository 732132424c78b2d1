// pick.js - what is at a pixel or a point, marks of it on the picture, and the distance of two.
import {byId, element, short} from "./dom.js";
import {project} from "./camera.js";
import {lengthUnit, valueUnit} from "./state.js";
import {length, sub} from "./vector.js";

const HOVER_MS = 150;
const NS = "http://www.w3.org/2000/svg";

export class Pick {
  constructor(app) {
    this.app = app;
    this.points = []; // at most two
    this.past = [];   // these, before each of the last two clicks
    this.turn = 0;    // answers to what was asked before are not awaited any more
    byId("card-close").addEventListener("click", () => { this.clear(); byId("picture").focus(); });
    byId("card-copy").addEventListener("click", () => app.copy(this.text, "The point is copied."));
  }

  // place: a pixel {x, y}, where a surface is met, or a {point} and the value there.
  async at(place) {
    const {turn} = this;
    this.past = [...this.past.slice(-1), this.points];
    const answer = await this.app.link.pick(place);
    if (!answer || turn !== this.turn) return;
    if (!answer.hit) return this.app.say(answer.why ?? (place.point ? "This is outside." : "There is nothing here."), true);
    this.points = [...this.points.slice(-1), this.pointOf(answer, place)];
    this.show();
  }

  // What is under a pointer that rests, while no button is down, is told in the line below the picture.
  hover(canvas, placeOf) {
    const quiet = () => { clearTimeout(this.resting); byId("under").textContent = ""; };
    canvas.addEventListener("pointerleave", quiet);
    canvas.addEventListener("pointerdown", quiet);
    canvas.addEventListener("pointermove", event => {
      quiet();
      if (event.buttons || event.pointerType === "touch") return;
      this.resting = setTimeout(async () => {
        const place = this.app.model && placeOf(event), mine = this.resting, hit = place && await this.app.link.pick(place);
        if (mine !== this.resting || !hit?.hit || hit.value == null || !this.app.model) return;
        byId("under").textContent = `${short(hit.value, 6)} ${this.units(hit).value}`.trim();
      }, HOVER_MS);
    });
  }

  // Slices are in their object's own world.
  pointOf(answer, place) {
    return {...answer, place, ...answer.point && {point: place.point ? this.app.placed(answer.point) : answer.point}};
  }

  // The data are another step's: values at points are asked for again, surfaces are elsewhere.
  async stepped() {
    const {points} = this;
    if (!points.length) return;
    if (!points.every(p => p.place.point)) return this.clear();
    const turn = ++this.turn, answers = await Promise.all(points.map(p => this.app.link.pick(p.place)));
    if (turn !== this.turn || !answers.every(a => a)) return;
    this.points = answers.map((a, i) => this.pointOf(a, points[i].place)).filter(a => a.hit);
    this.show();
  }

  // A double click picks nothing: as it was before its two clicks.
  undo() {
    this.turn++;
    this.points = this.past[0] ?? [];
    this.show();
  }

  clear() {
    this.turn++;
    this.points = [];
    this.show();
  }

  // The page knows the field of the object that is chosen.
  units(p) {
    const {volume, model} = this.app, across = lengthUnit(volume, model);
    const value = volume.scene && p.object !== volume.which ? "" : valueUnit(volume.fields[model.data.field], model);
    return {position: across, distance: across, value, gradient: value && across ? `${value}/${across}` : ""};
  }

  lines(p) {
    const vector = v => v.map(x => short(x, 6)).join(", "), {volume} = this.app, unit = this.units(p);
    const of = key => unit[key] ? ` ${unit[key]}` : "";
    const {cell} = volume.scene?.objects[p.object] ?? volume;
    return [volume.scene ? ["object", volume.files[p.object]] : null, p.through === "ray" ? null : ["position", vector(p.point) + of("position")], p.value === undefined ? null : ["value", p.value == null ? "no data" : short(p.value, 8) + of("value")],
      p.gradient == null ? null : ["gradient", `${vector(p.gradient)}  (${short(length(p.gradient), 4)}${of("gradient")})`],
      p.error_bound == null ? null : ["error bound", short(p.error_bound, 2)],
      p[cell] == null ? null : [cell, [p[cell]].flat().join(", ")],
      this.points.length === 2 ? ["distance", short(length(sub(this.points[1].point, this.points[0].point)), 7) + of("distance")] : null]
      .filter(Boolean);
  }

  show() {
    const p = this.points.at(-1);
    byId("card").hidden = !p;
    this.mark();
    if (!p) return;
    const lines = this.lines(p);
    // As text: numbers in full, with their units.
    const unit = this.units(p);
    const full = {position: p.point.join(", "), value: p.value, gradient: p.gradient?.join(", "), "error bound": p.error_bound,
      distance: this.points.length === 2 ? length(sub(this.points[1].point, this.points[0].point)) : null};
    this.text = lines.map(([a, b]) => full[a] == null ? `${a}: ${b}` : `${a}: ${full[a]} ${unit[a] ?? ""}`.trim()).join("\n");
    byId("card-text").replaceChildren(element("dl", {}, ...lines.flatMap(([a, b]) =>
      [element("dt", {}, a), element("dd", {"data-key": a}, b)])));
  }

  // Marks stay at their points while the camera moves.
  mark() {
    const svg = byId("marks"), {clientWidth: w, clientHeight: h} = byId("stage"), shapes = [];
    const at = this.points.map(p => project(this.app.model.camera, p.point, w / h)).map(p => p && [p[0] * w, p[1] * h]);
    const shape = (tag, attributes) => {
      const s = document.createElementNS(NS, tag);
      for (const [k, v] of Object.entries(attributes)) s.setAttribute(k, v);
      shapes.push(s);
    };
    if (at.length === 2 && at[0] && at[1])
      shape("line", {x1: at[0][0], y1: at[0][1], x2: at[1][0], y2: at[1][1]});
    for (const p of at.filter(Boolean)) {
      shape("circle", {cx: p[0], cy: p[1], r: 6, class: "halo"});
      shape("circle", {cx: p[0], cy: p[1], r: 6});
    }
    svg.replaceChildren(...shapes);
  }
}
