// colour_bar.js - the colour bar over the picture, in the page's letters. Saved pictures have the one that render draws.
import {byId, element, short} from "./dom.js";
import {valueUnit} from "./state.js";

const TICKS = 5, WIDTH = 256;

export class ColourBar {
  constructor(app) {
    this.app = app;
    this.canvas = element("canvas", {width: WIDTH, height: 1, "aria-hidden": "true"});
    this.title = element("span");
    this.ticks = element("div", {class: "ticks"});
    byId("colour-bar").append(this.title, this.canvas, this.ticks);
  }

  // Of what the page knows the colours of; else the picture has render's.
  get found() {
    const {model, media, volume} = this.app;
    return model.legend && model.volume.mode !== "off" && !volume.scene ? media.colours() : null;
  }

  // The flags without what is shown here.
  drawn({legend, ...flags}) { return legend && !this.found ? {...flags, legend} : flags; }

  show() {
    const {found, app} = this;
    byId("colour-bar").hidden = !found;
    if (!found) return;
    const {low, high, colours} = found, field = app.volume.fields[app.model.data.field], c = this.canvas.getContext("2d");
    const unit = valueUnit(field, app.model);
    this.title.textContent = [field.name || "value", unit && !field.name.includes(unit) ? `[${unit}]` : ""].filter(Boolean).join(" ");
    for (let x = 0; x < WIDTH; x++) {
      c.fillStyle = colours[Math.round(x / (WIDTH - 1) * (colours.length - 1))];
      c.fillRect(x, 0, 1, 1);
    }
    this.ticks.replaceChildren(...Array.from({length: TICKS}, (_, i) =>
      element("span", {}, short(low + (high - low) * i / (TICKS - 1)))));
  }
}
