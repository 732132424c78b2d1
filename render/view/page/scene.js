// scene.js - a scene of several objects: which are seen, which one the controls are about, what differs from the file.
//
// The model is about the object that is chosen. Of all that nobody has changed the file's own words are kept: a state
// says of the objects only what is changed, and values that no control has stay as they are.
import {byId, element} from "./dom.js";
import {flagsOfOne, flagsOfPicture, fromFlags, hasMedium, stepOf} from "./state.js";

const same = (a, b) => JSON.stringify(a) === JSON.stringify(b);

// raw: what the file says; base: what the page makes of that; now: what it makes of the model.
export function keep(raw, base, now) {
  const out = {};
  for (const key of new Set([...Object.keys(raw), ...Object.keys(now)])) {
    const value = same(now[key], base[key]) ? raw[key] : now[key];
    if (value !== undefined) out[key] = value;
  }
  return out;
}

// A point of an object's own world in the scene's. place: three rows of four numbers; or null.
export function placed(place, p) {
  return place ? [0, 4, 8].map(r => place[r] * p[0] + place[r + 1] * p[1] + place[r + 2] * p[2] + place[r + 3]) : p;
}

const CAMERA = ["eye", "look-at", "up", "fov"]; // flags replace them, but cannot take back an "ortho"
const MOMENT = ["field", "step", "time", "interpolate"];

export class Scene {
  constructor(app) {
    this.app = app;
    this.hidden = new Set();
    this.flags = new Map(); // of objects that are changed
    this.pages = new Map(); // what is the page's own, of each
    this.last = null;       // the state, while another object is being opened
  }

  get told() { return this.app.volume?.scene; }
  get chosen() { return this.app.volume.which; }
  get object() { return this.told?.objects[this.chosen]; }
  get raw() { return Object.fromEntries(Object.entries(this.app.volume.state).map(([k, v]) => [k.replaceAll("_", "-"), v])); }
  get firstShown() { return this.told.objects.find((_, i) => !this.hidden.has(i)); }

  // What cameras and clips are about.
  get world() {
    const {volume} = this.app;
    return volume?.scene ? {...volume, bounds: volume.scene.box} : volume;
  }

  // ---- the state ----

  // Takes what a state says of objects. Returns the model of the one that is chosen.
  adopt(state) {
    const {objects, ...picture} = state, {volume} = this.app, count = this.told.objects.length;
    this.hidden.clear();
    this.flags.clear();
    this.pages.clear();
    for (const o of Array.isArray(objects) ? objects : []) {
      if (!Number.isInteger(o?.index) || o.index < 0 || o.index >= count) continue;
      if (o.hidden === true) this.hidden.add(o.index);
      if (o.flags && typeof o.flags === "object" && !Array.isArray(o.flags)) this.flags.set(o.index, o.flags);
      if (o.page && typeof o.page === "object") this.pages.set(o.index, o.page);
    }
    if (this.hidden.size === count) this.hidden.clear();
    const own = this.object.flags, made = flags => fromFlags({...flags, page: this.pages.get(this.chosen)}, volume);
    const base = made({...this.raw, ...own});
    this.base = {one: this.one(base), picture: this.picture(base)};
    return made({...this.raw, ...picture, ...this.flags.get(this.chosen) ?? own});
  }

  one(model) {
    const {page, project, ...flags} = flagsOfOne(model, this.app.volume);
    return flags;
  }

  picture(model) { return flagsOfPicture(model, this.world, true, true); }

  // The state: flags of the picture, and what is changed of objects.
  state() {
    const {model, volume} = this.app, k = this.chosen, raw = this.object.flags, {page} = flagsOfOne(model, volume);
    const own = keep(raw, this.base.one, this.one(model));
    if (own.step !== raw.step) { delete own.time; delete own.interpolate; }
    this.set(k, own);
    if (page) this.pages.set(k, page);
    else this.pages.delete(k);
    this.share(own);
    const objects = this.told.objects.map((_, index) => ({index, ...this.hidden.has(index) && {hidden: true},
      ...this.flags.has(index) && {flags: this.flags.get(index)}, ...this.pages.has(index) && {page: this.pages.get(index)}}))
      .filter(o => Object.keys(o).length > 1);
    return {...keep(this.raw, this.base.picture, this.picture(model)), ...objects.length && {objects}};
  }

  // What is drawn of a state: while an object that is shown has a medium, none refracts.
  drawn(state) {
    const said = new Map((state.objects ?? []).map(o => [o.index, o])), flagsOf = (o, k) => said.get(k)?.flags ?? o.flags;
    const all = this.told?.objects ?? [], shown = k => !this.hidden.has(k);
    if (!all.some((o, k) => shown(k) && hasMedium(flagsOf(o, k), o.surface))) return state;
    const objects = all.flatMap((o, index) => {
      const {refract, ...flags} = flagsOf(o, index);
      return refract && shown(index) ? {index, ...said.get(index), flags} : said.get(index) ?? [];
    });
    return {...state, ...objects.length && {objects}};
  }

  set(k, flags) {
    if (same(flags, this.told.objects[k].flags)) this.flags.delete(k);
    else this.flags.set(k, flags);
  }

  // Objects of one file show the same field and step of it.
  share(own) {
    const {objects} = this.told, moment = f => MOMENT.map(key => f[key] ?? null);
    objects.forEach((o, j) => {
      const flags = this.flags.get(j) ?? o.flags;
      if (j === this.chosen || o.same !== this.object.same || same(moment(flags), moment(own))) return;
      const now = {...flags};
      for (const key of MOMENT) {
        delete now[key];
        if (own[key] !== undefined) now[key] = own[key];
      }
      if (now.iso && flags.field !== own.field) {
        const f = this.app.volume.fields[this.app.model.data.field], [suggested = f.data[1]] = stepOf(f, 0).suggested;
        for (const key of ["colour", "opacity", "reflect", "refract"]) if (now[key]) now[key] = now[key].slice(0, 1);
        now.iso = [suggested];
      }
      this.set(j, now);
    });
  }

  // ---- what changes it ----

  show(k, on) {
    if (on) this.hidden.delete(k);
    else this.hidden.add(k);
    this.build();
    this.app.pick.clear();
    this.app.changed(false);
  }

  choose(k) {
    const {app} = this;
    if (k === this.chosen || !app.model) return;
    this.last = this.state();
    app.data.stop();
    app.model = null;
    app.link.open(k);
  }

  build() {
    const {told} = this;
    byId("sec-objects").hidden = !told;
    if (!told) return;
    const shown = told.objects.length - this.hidden.size;
    byId("objects").replaceChildren(...told.objects.map((o, k) => {
      const name = this.app.volume.files[k], eye = element("input", {type: "checkbox", "aria-label": `${name} is shown`, title: "Shown"});
      eye.checked = !this.hidden.has(k);
      eye.disabled = eye.checked && shown === 1;
      eye.addEventListener("change", () => {
        this.show(k, eye.checked);
        byId("objects").querySelectorAll("input")[k].focus();
      });
      return element("div", {class: "object"}, eye, element("button", {"aria-pressed": String(k === this.chosen), title: "The controls are about this one",
        onclick: () => this.choose(k)}, name));
    }));
  }

  // ---- as a command ----

  // null: the scene file is not what is seen, whatever the flags; it has to be saved.
  commandFlags(state) {
    const {raw} = this, {objects = [], ...picture} = state, out = {};
    if (objects.some(o => o.hidden || o.flags) || Object.keys(raw).some(key => picture[key] === undefined && !CAMERA.includes(key))) return null;
    for (const [key, value] of Object.entries(picture))
      if (key === "ortho" || CAMERA.includes(key) || !same(value, raw[key])) out[key] = value;
    if (this.told.links) out["follow-links"] = true;
    return out;
  }
}
