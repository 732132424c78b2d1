// main.js - puts the page together: the model, the panel, the picture.
import {Annotate} from "./annotate.js";
import {AXES, axisView, drive, fit, setUp, sides, upward, widen} from "./camera.js";
import {Clip} from "./clip.js";
import {ColourBar} from "./colour_bar.js";
import {Crash} from "./crash.js";
import {Data} from "./data.js";
import {byId, choice, element, slider} from "./dom.js";
import {Honesty} from "./honesty.js";
import {Light} from "./light.js";
import {Link} from "./link.js";
import {Movie} from "./movie.js";
import {Pick} from "./pick.js";
import {Save} from "./save.js";
import {Scene, placed} from "./scene.js";
import {Screen} from "./screen.js";
import {fromFlags, fromFragment, stepOf, toFlags, toFragment} from "./state.js";
import {Slices} from "./slice.js";
import {Surfaces} from "./surfaces.js";
import {add, scale, sub, unit} from "./vector.js";
import {Volume} from "./volume.js";

const REST_MS = 120, GLIDE_MS = 220, SAY_MS = 4000, PROPORTION = 16 / 9;

class App {
  constructor() {
    this.model = null;
    this.volume = null;
    this.flying = false;
    this.models = new Map(); // of the files that were shown before, by their number
    this.link = new Link(new URLSearchParams(location.search).get("token") ?? "");
    this.screen = new Screen(byId("picture"), () => this.changed(false));
    this.scene = new Scene(this);
    this.surfaces = new Surfaces(this);
    this.media = new Volume(this);
    this.pick = new Pick(this);
    this.slices = new Slices(this);
    this.clip = new Clip(this);
    this.light = new Light(this);
    this.annotate = new Annotate(this);
    this.bar = new ColourBar(this);
    this.data = new Data(this);
    this.honesty = new Honesty(this);
    this.save = new Save(this);
    this.movie = new Movie(this);
    this.crash = new Crash(this);
    this.listen();
    this.hands();
    this.tools();
  }

  // ---- what comes in ----

  listen() {
    const on = (type, f) => this.link.addEventListener(type, event => f(event.detail));
    on("volume", volume => { this.crash.connected(volume); this.show(volume); });
    on("steps", held => this.data.hold(held));
    on("present", marks => this.data.mark(marks));
    on("grown", volume => { if (volume.which === this.volume?.which) this.grow(volume); });
    on("stuck", ({why}) => this.honesty.stuck(why));
    on("picture", ({head, bitmap, latency}) => {
      this.screen.show(head, bitmap);
      this.honesty.picture(head, latency);
      this.data.shown(head);
      this.movie.shown(head);
      this.crash.shown(head);
      if (head.number >= this.unproven) this.unproven = 0;
      if (this.refused && head.number > this.refused) { this.refused = 0; this.quiet(); }
    });
    on("refused", ({number, why}) => {
      if (this.unproven && number >= this.unproven) return this.drop(why);
      this.refused = number ?? 0;
      if (number) this.honesty.mark("not drawn", "bad");
      this.say(why);
    });
    on("closed", ({there}) => {
      this.honesty.mark("not connected", "bad");
      this.say(there ? "The server is there, but does not take this page: open the address that it has printed, or close other pages."
        : "The connection is lost; trying again.");
    });
    on("open", () => { this.honesty.mark("connecting", ""); this.quiet(); });
    window.addEventListener("hashchange", () => {
      const flags = location.hash !== this.fragment && this.volume && this.addressed();
      if (!flags) return;
      clearTimeout(this.writing);
      const other = this.numberOf(flags.file);
      if (this.scene.told && other !== this.volume.which) this.scene.last = flags;
      if (other === this.volume.which) return this.adopt(flags, false, true);
      this.open(other);
      this.models.delete(other);
    });
  }

  show(volume) {
    const again = this.model && volume.which === this.volume.which;
    // A new connection begins with the first file, the page does not.
    if (this.model && !again) return void this.link.open(this.volume.which);
    this.volume = volume;
    document.body.classList.toggle("surface-itself", volume.surface);
    document.body.classList.toggle("of-scene", Boolean(volume.scene));
    byId("slices-toggle").disabled = volume.surface;
    for (const [k, name] of sides(volume).entries()) byId("axis").options[k + 1].textContent = name;
    const first = !this.opened, saved = first ? this.addressed() : fromFragment(location.hash);
    this.opened = true;
    if (first && saved && this.numberOf(saved.file) !== volume.which) return void this.link.open(this.numberOf(saved.file));
    this.entitle();
    if (volume.scene) return this.showObject(saved, first, again);
    if (again) return void (this.crash.after ? this.crash.goOn() : this.changed(false));
    const before = this.models.get(volume.which);
    if (before) return this.take(before);
    const mine = saved && [undefined, volume.file, volume.which].includes(saved.file) ? saved : null;
    this.adopt(mine ?? volume.state, !mine, Boolean(mine));
  }

  // The state in the address; null: there is none, which is told where something else is.
  addressed() {
    const saved = fromFragment(location.hash), text = location.hash.slice(1);
    if (!saved && text && !document.getElementById(text)) this.dropped = "no state of a picture";
    return saved;
  }

  // What the address holds cannot be drawn: it gives way to what the page begins with.
  drop(why) {
    this.unproven = 0;
    this.adopt(this.volume.state, true);
    this.say(`What the address holds is dropped: ${why}.`);
  }

  // What the page shows of a scene stays, whichever of its objects the controls are about.
  showObject(saved, first, again) {
    const {last} = this.scene, {state} = this.volume;
    this.scene.last = null;
    if (again && !last) return void (this.crash.after ? this.crash.goOn() : this.changed(false));
    this.adopt(last ?? (first && saved ? saved : state), first && !saved, first && Boolean(saved) && !last);
  }

  // The file that is shown has further steps, whose values may reach further.
  grow(volume) {
    const ranges = v => JSON.stringify(v.fields.map(f => f.range)), before = ranges(this.volume);
    this.volume = volume;
    if (ranges(volume) !== before) for (const part of [this.surfaces, this.media]) part.build();
    this.data.grown();
  }

  entitle() {
    const v = this.volume, file = v.file.replace(/\.leaf$/, "");
    if (v.scene) {
      byId("name").replaceChildren(v.scene.file, element("small", {}, `${v.files.length} objects`));
      document.title = `${v.scene.file} – leafcast`;
      return;
    }
    const size = v.dims[0] ? v.dims.join("×") : `${v.cells.toLocaleString("en")} ${v.cell}s`;
    byId("name").replaceChildren(file, element("small", {}, v.name && v.name !== file ? `${v.name}, ${size}` : size));
    document.title = `${file} – leafcast`;
  }

  // In the address a file has its name, or its number where several have that name.
  get fileKey() {
    const {files, which} = this.volume, file = files[which];
    return files.length < 2 ? null : files.indexOf(file) === files.lastIndexOf(file) ? file : which;
  }

  // The one that is shown, where there is none.
  numberOf(key) {
    const {files, which} = this.volume, found = Number.isInteger(key) ? key : files.indexOf(key);
    return found >= 0 && found < files.length ? found : which;
  }

  // Draw what these flags say. first: they are the server's, made for a wide picture. foreign: they are the address's,
  // and may be anything.
  adopt(flags, first = false, foreign = false) {
    try {
      const {file, ...state} = flags;
      this.model = this.modelOf(state);
      this.unproven = foreign ? this.link.number + 1 : 0; // the first view of it
      if (first && this.volume.scene?.fitted !== false) this.widen();
      this.home = first ? this.stands : null;
      this.seenWith = 0; // the margin with which all of the volume was shown
      this.take(this.model);
    } catch (error) {
      if (first) throw error;
      if (foreign) return this.drop("no state of a picture");
      this.adopt(this.volume.state, true);
      this.say("This is no state of a picture.");
    }
    if (this.dropped) this.say(`What the address holds is dropped: ${this.dropped}.`);
    this.dropped = null;
  }

  modelOf(state) { return this.scene.told ? this.scene.adopt(state) : fromFlags(state, this.volume); }

  // The state, which the address keeps; and what is drawn of it.
  get kept() { return this.scene.told ? this.scene.state() : toFlags(this.model, this.volume); }
  get flags() { return this.scene.drawn(this.kept); }

  // What cameras and clips are about.
  get world() { return this.scene.world; }

  // A point of the volume's own world, where it is seen.
  placed(point) { return placed(this.scene.object?.place, point); }

  take(model) {
    this.model = model;
    this.up = upward(model.camera);
    this.pick.clear();
    this.build();
    this.changed(false);
  }

  build() {
    for (const part of [this.scene, this.surfaces, this.media, this.slices, this.clip, this.light, this.annotate, this.data, this.movie]) part.build();
    this.cameraPanel();
  }

  // One picture of a movie; the controls stay as they are. Returns its view's number.
  film(flags) {
    this.model = fromFlags(flags, this.volume);
    return this.changed(true, true);
  }

  // What is shown of this file is kept for when it is opened again.
  open(file) {
    this.movie.stop();
    this.data.stop();
    if (this.model) this.models.set(this.volume.which, this.model);
    this.model = null;
    this.link.open(file);
  }

  chooseField(k) {
    this.model.data.field = k;
    const f = this.volume.fields[k], [suggested = f.data[1]] = stepOf(f, this.model.data.step).suggested;
    this.model.surfaces = this.model.surfaces.slice(0, 1).map(s => ({...s, iso: suggested}));
    Object.assign(this.model.volume, {points: [], window: null, first: suggested,
      preset: this.model.volume.preset === "custom" ? "auto" : this.model.volume.preset});
    this.model.slices.window = null;
    this.pick.clear();
    this.build();
    this.changed(false);
  }

  // Another step is shown.
  stepped() {
    for (const part of [this.surfaces, this.media, this.pick]) part.stepped();
  }

  // ---- what goes out ----

  // changed() - the model is another: draw it. moving: the hand is at it; when it has rested, it is
  // drawn in full. keep: others say when it rests. Returns the number that the view will have.
  changed(moving, keep = false) {
    clearTimeout(this.rest);
    if (!this.model) return 0;
    const {kept} = this, flags = this.scene.drawn(kept);
    if (moving && !keep) this.rest = setTimeout(() => this.changed(false), REST_MS);
    if (!moving) this.remember(kept);
    this.pick.mark();
    this.slices.update(moving);
    this.annotate.outline(moving);
    this.bar.show();
    this.screen.canvas.classList.toggle("clear", this.model.light.clear);
    byId("ortho").setAttribute("aria-pressed", this.model.camera.ortho);
    this.fov?.set(this.model.camera.fov);
    this.upChoice?.set(AXES.indexOf(this.model.camera.up.join()));
    const number = this.link.view(this.bar.drawn(flags), this.screen.width, this.screen.height, moving, this.honesty.where);
    this.crash.ask(number, kept);
    return number;
  }

  // sliced() - likewise of the slices alone.
  sliced(moving) {
    clearTimeout(this.sliceRest);
    if (moving) this.sliceRest = setTimeout(() => this.sliced(false), REST_MS);
    else this.remember(this.kept);
    this.slices.update(moving);
  }

  remember(flags) {
    this.fragment = toFragment(flags, this.fileKey);
    clearTimeout(this.writing);
    // Browsers limit how often.
    this.writing = setTimeout(() => {
      history.replaceState(null, "", this.fragment);
      this.fragment = location.hash;
    }, 200);
  }

  // ---- hands ----

  hands() {
    const canvas = byId("picture");
    window.addEventListener("pointerdown", () => document.body.classList.add("pointed"), true);
    window.addEventListener("keydown", () => document.body.classList.remove("pointed"), true);
    drive(canvas, {
      camera: () => this.model?.camera,
      volume: () => this.world,
      changed: moving => this.changed(moving),
      flying: () => this.flying,
      clicked: event => this.pick.at(this.pixel(event)),
      pivot: event => this.pivot(this.pixel(event)),
    });
    this.pick.hover(canvas, event => this.pixel(event));
    canvas.addEventListener("keydown", event => {
      if (event.ctrlKey || event.metaKey || event.altKey || !this.model) return;
      const key = event.key.toLowerCase();
      if (key >= "1" && key <= "6") this.axis(+key - 1);
      else if (key === "f") this.fit();
      else if (key === "r") this.reset();
      else if (key === "u") this.turnOver();
      else if (key === "x") this.pick.at({x: this.screen.width / 2, y: this.screen.height / 2});
      else if (key === "escape") { this.pick.clear(); this.quiet(); }
      else return;
      event.preventDefault();
    });
    window.addEventListener("keydown", event => {
      if (event.ctrlKey || event.metaKey || event.altKey || byId("save").open) return;
      if (event.target.matches("input:not([type=checkbox],[type=range],[type=color]), select")) return;
      if (event.key === "?") return this.help();
      const button = {o: "ortho", g: "fly", l: "slices-toggle", p: "toggle", c: "copy-command"}[event.key.toLowerCase()];
      if (button) byId(button).click();
    });
  }

  async pivot(pixel) {
    this.pick.undo();
    const hit = await this.link.pick(pixel);
    if (hit?.hit) this.glide(hit.point);
  }

  pixel(event) {
    const [x, y] = this.screen.pixel(event);
    return {x, y};
  }

  // What is looked at becomes this point, in a moment and not at once.
  glide(point) {
    const c = this.model.camera, from = c.lookAt, away = sub(point, from), eye = c.eye, began = performance.now();
    const step = now => {
      const t = Math.min(1, (now - began) / GLIDE_MS), s = t * t * (3 - 2 * t);
      c.lookAt = t === 1 ? point : add(from, scale(away, s));
      c.eye = add(eye, scale(away, s));
      this.changed(t < 1);
      if (t < 1 && this.model?.camera === c) requestAnimationFrame(step);
    };
    requestAnimationFrame(step);
  }

  fit() {
    const {box} = this.model.clip, bounds = box ? [box.slice(0, 3), box.slice(3)] : this.world.bounds;
    fit(this.model.camera, bounds, this.screen.width / this.screen.height, this.annotate.margin);
    this.changed(false);
  }

  reset() {
    this.model.camera = fromFlags(this.volume.state, this.volume).camera;
    this.up = upward(this.model.camera);
    if (this.volume.scene?.fitted !== false) this.widen();
    this.home = this.stands;
    this.seenWith = 0;
    this.changed(false);
  }

  get stands() { return JSON.stringify(this.model.camera); }

  // The first camera is for a surface: who has not moved it yet wants to see all of the volume.
  seeVolume() {
    const {margin} = this.annotate;
    if (this.stands !== this.home || this.seenWith === margin || this.scene.told) return;
    this.fit();
    this.home = this.stands;
    this.seenWith = margin;
  }

  // What points up in the picture, and stays so in views along axes.
  raise(up) {
    setUp(this.model.camera, up);
    this.up = up;
    this.changed(false);
  }

  turnOver() {
    const over = v => v.map(x => -x || 0), c = this.model.camera;
    c.up = over(c.up);
    this.up = over(this.up);
    this.changed(false);
  }

  // The server's cameras are made for a wide picture. Of a volume it tells how far they are in others; that is convex in
  // 1 / aspect, so that between two of these nothing is cut off.
  widen() {
    const aspect = this.screen.width / this.screen.height, {fits, scene} = this.volume, c = this.model.camera;
    if (!scene) {
      const k = Math.max(1, fits.filter(([a]) => a < aspect).length), [[a, near], [b, far]] = [fits[k - 1], fits[k] ?? fits[k - 1]];
      const share = Math.min(1, Math.max(0, (1 / a - 1 / aspect) / (1 / a - 1 / b || 1)));
      c.eye = add(c.lookAt, scale(unit(sub(c.eye, c.lookAt)), near + share * (far - near)));
    } else if (aspect < PROPORTION) widen(this.model.camera, this.world.bounds, aspect, PROPORTION / aspect);
  }

  axis(k) {
    axisView(this.model.camera, k, this.up);
    this.changed(false);
  }

  tools() {
    const click = (id, f) => byId(id).addEventListener("click", () => this.model && f(byId(id)));
    click("fit", () => this.fit());
    click("ortho", () => { this.model.camera.ortho = !this.model.camera.ortho; this.changed(false); });
    click("fly", button => {
      this.flying = !this.flying;
      button.setAttribute("aria-pressed", this.flying);
      byId("picture").focus();
    });
    byId("axis").addEventListener("change", event => {
      if (this.model && event.target.value) this.axis(+event.target.value);
      event.target.value = "";
    });
    byId("message-close").addEventListener("click", () => { this.quiet(); byId("picture").focus(); });
    byId("toggle").addEventListener("click", () => {
      const wide = document.body.classList.toggle("wide");
      byId("toggle").setAttribute("aria-expanded", !wide);
      byId(wide ? "stage" : "panel").prepend(byId("card"));
    });
  }

  help() {
    if (document.body.classList.contains("wide")) byId("toggle").click();
    byId("sec-camera").open = true;
    byId("keys").scrollIntoView();
  }

  cameraPanel() {
    this.fov = slider("Field of view", {min: 5, max: 120, step: 1, value: this.model.camera.fov,
      change: (v, resting) => { this.model.camera.fov = v; this.changed(!resting); }});
    this.upChoice = choice("Up", {options: [[-1, "as rolled"], ...sides(this.volume).entries()],
      value: -1, change: k => k >= 0 && this.raise(AXES[k].split(",").map(Number))});
    byId("camera").replaceChildren(this.fov, this.upChoice, element("div", {class: "row"},
      element("button", {onclick: () => this.fit()}, "Fit all"),
      element("button", {onclick: () => this.reset()}, "Reset camera")));
  }

  // ---- words ----

  // note: it goes by itself, unless it is to stay.
  say(text, note = false, stay = false) {
    const message = byId("message");
    byId("message-text").textContent = text;
    message.classList.toggle("note", note);
    message.hidden = false;
    clearTimeout(this.saying);
    if (note && !stay) this.saying = setTimeout(() => this.quiet(), SAY_MS);
  }

  quiet() { byId("message").hidden = true; }

  // A page from another machine may not use the clipboard, but copy what is selected; where that is not
  // allowed either, the text is shown, to be copied by hand.
  async copy(text, done) {
    this.copied = text;
    try {
      await navigator.clipboard.writeText(text);
      this.say(done, true);
    } catch {
      if (copySelected(text)) this.say(done, true);
      else this.say(text, true, true);
    }
  }
}

function copySelected(text) {
  const before = document.activeElement, area = element("textarea", {class: "aside", readonly: true});
  area.value = text;
  document.body.append(area);
  area.select();
  const done = document.execCommand("copy");
  area.remove();
  before?.focus();
  return done;
}

window.leafcast = new App();
