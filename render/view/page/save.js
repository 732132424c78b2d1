// save.js - pictures, states and commands to take along.
import {byId, element} from "./dom.js";
import {command, toFlags} from "./state.js";

export function download(blob, name) {
  const url = URL.createObjectURL(blob);
  const a = element("a", {href: url, download: name});
  document.body.append(a);
  a.click();
  a.remove();
  setTimeout(() => URL.revokeObjectURL(url), 10000);
}

export class Save {
  constructor(app) {
    this.app = app;
    const dialog = byId("save");
    this.hint = byId("save-hint").textContent;
    byId("save-open").addEventListener("click", () => {
      if (!app.model) return;
      byId("save-width").value = app.screen.width;
      byId("save-height").value = app.screen.height;
      const scene = Boolean(app.scene.told);
      byId("save-scene").hidden = !scene;
      byId("save-state").hidden = byId("load-row").hidden = scene;
      byId("save-hint").textContent = scene ? `The address of this page holds the state, too. A saved scene goes beside ${app.scene.told.file}: `
        + "its files are named as there." : this.hint;
      dialog.showModal();
    });
    dialog.addEventListener("close", () => {
      if (dialog.returnValue === "picture") this.picture(+byId("save-width").value,
        +byId("save-height").value, byId("save-format").value);
      if (dialog.returnValue === "state") this.state();
      if (dialog.returnValue === "scene") this.scene();
      dialog.returnValue = "";
    });
    byId("save-cancel").addEventListener("click", () => this.drawing?.abort());
    byId("load-state").addEventListener("change", event => this.load(event.target));
    byId("copy-command").addEventListener("click", () => this.command());
  }

  get name() { return (this.app.scene.told ?? this.app.volume).file.replace(/\.(leaf|json)$/, "").replace(/[^\w.-]+/g, "_") || "leafcast"; }

  command() {
    const {app} = this;
    if (!app.model) return;
    if (app.scene.told) return this.sceneCommand();
    const line = command(toFlags(app.model, app.volume), app.volume.path, app.screen.width, app.screen.height);
    app.copy(line, "The command is copied.");
  }

  // Where the file does not say what is seen, it is saved first.
  async sceneCommand() {
    const {app} = this, {width, height} = app.screen, {told} = app.scene, flags = app.scene.commandFlags(app.flags);
    const saved = flags ? null : await this.scene();
    if (!flags && !saved) return;
    const line = command(flags ?? (told.links ? {"follow-links": true} : {}), saved ? told.path.replace(/[^/]*$/, "") + saved : told.path, width, height);
    app.copy(line, saved ? `The command is copied. It draws ${saved}, which is saved: put it beside ${told.file}.` : "The command is copied.");
  }

  // The scene as it is seen. Returns the name of its file; null: it could not be saved.
  async scene() {
    const {app} = this, query = new URLSearchParams({token: app.link.token, state: JSON.stringify(app.flags)}), name = `${this.name}-view.json`;
    try {
      const answer = await fetch(`scene?${query}`);
      if (!answer.ok) throw new Error((await answer.text()).slice(0, 300) || `error ${answer.status}`);
      download(await answer.blob(), name);
      return name;
    } catch (error) {
      app.say(`The scene cannot be saved: ${error.message}`);
      return null;
    }
  }

  // One at a time; another tries anew.
  async picture(width, height, type) {
    const {app} = this, state = JSON.stringify(app.flags);
    const query = new URLSearchParams({token: app.link.token, state, size: `${width}x${height}`, type});
    if (app.volume.files?.length > 1) query.set("file", app.volume.which);
    this.drawing?.abort();
    const drawing = this.drawing = new AbortController(), name = `${this.name}.${type}`;
    byId("saving-text").textContent = `Drawing ${width} × ${height}…`;
    byId("saving").hidden = false;
    try {
      const answer = await fetch(`picture?${query}`, {signal: drawing.signal});
      if (!answer.ok) throw new Error((await answer.text()).slice(0, 300) || `error ${answer.status}`);
      download(await answer.blob(), name);
      app.say("The picture is saved.", true);
    } catch (error) {
      if (!drawing.signal.aborted) app.say(`The picture cannot be saved: ${error.message}`);
      else if (drawing === this.drawing) app.say("No picture is saved.", true);
    }
    if (drawing === this.drawing) byId("saving").hidden = true;
  }

  state() {
    const text = JSON.stringify(toFlags(this.app.model, this.app.volume), null, 1) + "\n";
    download(new Blob([text], {type: "application/json"}), `${this.name}.json`);
  }

  async load(input) {
    const file = input.files[0];
    if (!file) return;
    try {
      const flags = JSON.parse(await file.text());
      if (!flags || typeof flags !== "object" || Array.isArray(flags)) throw new Error("not a JSON object");
      this.app.adopt(flags);
      byId("save").close("");
    } catch (error) {
      this.app.say(`${file.name} is no state: ${error.message}`);
    }
    input.value = "";
  }
}
