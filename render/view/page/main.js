// main.js - puts the page together: the model, the panel, the picture.
import {Annotate} from "./annotate.js";
import {axisView, dolly, drive, fit, widen} from "./camera.js";
import {Clip} from "./clip.js";
import {Data} from "./data.js";
import {byId, element, slider} from "./dom.js";
import {Honesty} from "./honesty.js";
import {Light} from "./light.js";
import {Link} from "./link.js";
import {Movie} from "./movie.js";
import {Pick} from "./pick.js";
import {Save} from "./save.js";
import {Screen} from "./screen.js";
import {fromFlags, fromFragment, toFlags, toFragment} from "./state.js";
import {Slices} from "./slice.js";
import {Surfaces} from "./surfaces.js";
import {add, scale, sub} from "./vector.js";
import {Volume} from "./volume.js";

const REST_MS = 120, GLIDE_MS = 220, SAY_MS = 4000, PROPORTION = 16 / 9;

class App {
  constructor() {
    this.model = null;
    this.volume = null;
    this.flying = false;
    this.link = new Link(new URLSearchParams(location.search).get("token") ?? "");
    this.screen = new Screen(byId("picture"), () => this.changed(false));
    this.surfaces = new Surfaces(this);
    this.media = new Volume(this);
    this.slices = new Slices(this);
    this.clip = new Clip(this);
    this.light = new Light(this);
    this.annotate = new Annotate(this);
    this.data = new Data(this);
    this.pick = new Pick(this);
    this.honesty = new Honesty(this);
    this.save = new Save(this);
    this.movie = new Movie(this);
    this.listen();
    this.hands();
    this.tools();
  }

  // ---- what comes in ----

  listen() {
    const on = (type, f) => this.link.addEventListener(type, event => f(event.detail));
    on("volume", volume => this.show(volume));
    on("picture", ({head, bitmap, latency}) => {
      this.screen.show(head, bitmap);
      this.honesty.picture(head, latency);
      this.data.shown(head);
      this.movie.shown(head);
      if (this.refused && head.number > this.refused) { this.refused = 0; this.quiet(); }
    });
    on("refused", ({number, why}) => {
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
      const flags = location.hash !== this.fragment && this.volume && fromFragment(location.hash);
      if (flags) this.adopt(flags);
    });
  }

  show(volume) {
    const again = this.volume && this.model && volume.file === this.volume.file;
    // A new connection begins with the first file, the page does not.
    const shown = this.model && !again ? volume.files.indexOf(this.volume.file) : -1;
    if (shown >= 0) return void this.link.open(shown);
    this.volume = volume;
    const saved = fromFragment(location.hash);
    const other = saved?.file && volume.files ? volume.files.indexOf(saved.file) : -1;
    if (!again && !this.opened && other >= 0 && other !== volume.which) {
      this.opened = true;
      this.link.open(other);
      return;
    }
    this.opened = true;
    byId("name").replaceChildren(volume.name || volume.file, element("small", {}, volume.kind === "grid"
      ? volume.dims.join("×") : `${volume.tets.toLocaleString("en")} tets`));
    document.title = `${volume.name || volume.file} – leafcast`;
    if (again) return this.changed(false);
    const mine = saved && (!saved.file || saved.file === volume.file) ? saved : null;
    this.adopt(mine ?? volume.state, !mine);
  }

  // Draw what these flags say. first: they are the server's, made for a wide picture.
  adopt(flags, first = false) {
    try {
      const {file, ...state} = flags;
      this.model = fromFlags(state, this.volume);
    } catch {
      this.say("This is no state of a picture.");
      this.model = fromFlags(this.volume.state, this.volume);
    }
    if (first) this.widen();
    this.pick.clear();
    this.build();
    this.changed(false);
  }

  build() {
    for (const part of [this.surfaces, this.media, this.slices, this.clip, this.light, this.annotate, this.data, this.movie]) part.build();
    this.cameraPanel();
  }

  // One picture of a movie; the controls stay as they are. Returns its view's number.
  film(flags) {
    this.model = fromFlags(flags, this.volume);
    return this.changed(true, true);
  }

  open(file) {
    this.model = null;
    this.link.open(file);
  }

  chooseField(k) {
    this.model.data.field = k;
    const f = this.volume.fields[k];
    this.model.surfaces = this.model.surfaces.slice(0, 1).map(s => ({...s, iso: f.suggested[0] ?? f.data[1]}));
    Object.assign(this.model.volume, {points: [], window: null, first: f.suggested[0] ?? f.data[1],
      preset: this.model.volume.preset === "custom" ? "auto" : this.model.volume.preset});
    this.pick.clear();
    this.build();
    this.changed(false);
  }

  // ---- what goes out ----

  // changed() - the model is another: draw it. moving: the hand is at it; when it has rested, it is
  // drawn in full. keep: others say when it rests. Returns the number that the view will have.
  changed(moving, keep = false) {
    clearTimeout(this.rest);
    if (!this.model) return 0;
    const flags = toFlags(this.model, this.volume);
    if (moving && !keep) this.rest = setTimeout(() => this.changed(false), REST_MS);
    if (!moving) this.remember(flags);
    this.pick.mark();
    this.slices.update(moving);
    this.annotate.outline(moving);
    this.screen.canvas.classList.toggle("clear", this.model.light.clear);
    byId("ortho").setAttribute("aria-pressed", this.model.camera.ortho);
    this.fov?.set(this.model.camera.fov);
    return this.link.view(flags, this.screen.width, this.screen.height, moving, this.honesty.where);
  }

  // sliced() - likewise of the slices alone.
  sliced(moving) {
    clearTimeout(this.sliceRest);
    if (moving) this.sliceRest = setTimeout(() => this.sliced(false), REST_MS);
    else this.remember(toFlags(this.model, this.volume));
    this.slices.update(moving);
  }

  remember(flags) {
    this.fragment = toFragment(flags, this.volume.files?.length > 1 ? this.volume.file : null);
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
    drive(canvas, {
      camera: () => this.model?.camera,
      volume: () => this.volume,
      changed: moving => this.changed(moving),
      flying: () => this.flying,
      clicked: event => this.pick.at(...this.screen.pixel(event)),
      pivot: event => this.pivot(...this.screen.pixel(event)),
    });
    canvas.addEventListener("keydown", event => {
      if (event.ctrlKey || event.metaKey || event.altKey || !this.model) return;
      const key = event.key.toLowerCase();
      if (key >= "1" && key <= "6") this.axis(+key - 1);
      else if (key === "f") this.fit();
      else if (key === "r") this.reset();
      else if (key === "x") this.pick.at(this.screen.width / 2, this.screen.height / 2);
      else if (key === "escape") this.pick.clear();
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

  async pivot(x, y) {
    const hit = await this.link.pick(x, y);
    if (hit?.hit) this.glide(hit.point);
  }

  // What is looked at becomes this point, in a moment and not at once.
  glide(point) {
    const c = this.model.camera, from = c.lookAt, away = sub(point, from), eye = c.eye, began = performance.now();
    const step = now => {
      const t = Math.min(1, (now - began) / GLIDE_MS), s = t * t * (3 - 2 * t);
      c.lookAt = t === 1 ? point : add(from, scale(away, s));
      c.eye = add(eye, scale(away, s));
      this.changed(t < 1);
      if (t < 1 && this.model.camera === c) requestAnimationFrame(step);
    };
    requestAnimationFrame(step);
  }

  fit() {
    const {box} = this.model.clip, bounds = box ? [box.slice(0, 3), box.slice(3)] : this.volume.bounds;
    fit(this.model.camera, bounds, this.screen.width / this.screen.height);
    this.changed(false);
  }

  reset() {
    this.model.camera = fromFlags(this.volume.state, this.volume).camera;
    this.widen();
    this.changed(false);
  }

  // The server's cameras are made for a wide picture.
  widen() {
    const aspect = this.screen.width / this.screen.height;
    if (aspect < PROPORTION) widen(this.model.camera, this.volume.bounds, aspect, PROPORTION / aspect);
  }

  axis(k) {
    axisView(this.model.camera, k);
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
    byId("toggle").addEventListener("click", () => {
      const wide = document.body.classList.toggle("wide");
      byId("toggle").setAttribute("aria-expanded", !wide);
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
    byId("camera").replaceChildren(this.fov, element("div", {class: "row"},
      element("button", {onclick: () => this.fit()}, "Fit all"),
      element("button", {onclick: () => this.reset()}, "Reset camera")));
  }

  // ---- words ----

  say(text, note = false) {
    const message = byId("message");
    message.textContent = text;
    message.classList.toggle("note", note);
    message.hidden = false;
    clearTimeout(this.saying);
    if (note) this.saying = setTimeout(() => this.quiet(), SAY_MS);
  }

  quiet() { byId("message").hidden = true; }

  async copy(text, done) {
    this.copied = text;
    try {
      await navigator.clipboard.writeText(text);
      this.say(done, true);
    } catch {
      // Without the right to the clipboard the text is shown, to be copied by hand.
      this.say(text, true);
    }
  }
}

window.leafcast = new App();
