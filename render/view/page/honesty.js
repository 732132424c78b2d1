// honesty.js - what the picture is: exact or not, how far off, and what it took; where it is provisional.
import {byId, bytes, check, element, short} from "./dom.js";
import {Treelets} from "./treelets.js";

const PROVISIONAL = "rgba(255, 60, 200, .45)";

export class Honesty {
  constructor(app) {
    this.app = app;
    this.where = false; // mark what is provisional
    this.mapped = false;
    this.treelets = new Treelets();
    this.boxes = {
      where: check("Mark what is provisional", {value: false, change: on => {
        this.where = on;
        this.overlay({});
        app.changed(false);
      }}),
      mapped: check("Map of treelets", {value: false, change: on => {
        this.mapped = on;
        this.treelets.box.hidden = !on;
        this.ask();
        app.changed(false);
      }})};
    byId("honesty").append(...Object.values(this.boxes), this.treelets.box);
    app.link.addEventListener("open", () => this.ask());
    app.link.addEventListener("treelets", event => this.treelets.show(event.detail));
  }

  // Say what is to be told of memory: the map, and how much of each step.
  ask() { this.app.link.send({type: "residency", on: this.mapped, steps: this.app.volume?.steps.length > 1}); }

  // Over the picture, as many squares as the server speaks of.
  overlay({where, width, height}) {
    const canvas = byId("provisional");
    canvas.hidden = !where;
    if (!where) return;
    const {side, columns, runs} = where, rows = Math.ceil(height / side);
    canvas.width = columns;
    canvas.height = rows;
    canvas.style.width = `${100 * columns * side / width}%`;
    canvas.style.height = `${100 * rows * side / height}%`;
    const context = canvas.getContext("2d");
    context.fillStyle = PROVISIONAL;
    runs.reduce((at, run, k) => {
      for (let i = k % 2 ? at : at + run; i < at + run;) {
        const x = i % columns, n = Math.min(columns - x, at + run - i);
        context.fillRect(x, Math.floor(i / columns), n, 1);
        i += n;
      }
      return at + run;
    }, 0);
  }

  // Why no further steps come to the file that is shown; null: they may.
  stuck(why) {
    const line = byId("stuck");
    line.hidden = !why;
    line.textContent = line.title = why ? `no further steps: ${why}` : "";
  }

  mark(text, kind) {
    const mark = byId("exact");
    if (mark.textContent !== text) mark.textContent = text;
    mark.className = `mark ${kind}`;
  }

  picture(head, latency) {
    const s = head.stats ?? {}, parts = [], add = (name, value, more) =>
      parts.push(element("span", {class: more ? "more" : ""}, `${name} `, element("b", {}, value)));
    const count = n => n.toLocaleString("en");
    if (head.final && head.exact && head.certified !== false) this.mark("exact", "exact");
    else if (!head.final && head.scale > 1) this.mark(`preview, 1/${head.scale}`, "");
    else if (head.final) this.mark(head.exact ? "not certified" : "final, not exact", "");
    else this.mark("refining", "");
    if (head.provisional > 0) add("provisional", `${count(head.provisional)} px`);
    if (head.uncertified > 0) add("uncertified", `${count(head.uncertified)} px`);
    if (head.error > 0) add("error ≤", short(head.error, 2));
    if (head.lod_level > 0) add("level", head.lod_level);
    add("frame", `${head.render_ms.toFixed(head.render_ms < 10 ? 1 : 0)} ms`);
    if (latency != null && !head.final) add("seen after", `${latency.toFixed(0)} ms`, true);
    if (s.treelets_total != null)
      add("treelets", `${count(s.treelets_loaded)} / ${count(s.treelets_active)} / ${count(s.treelets_total)}`);
    if (s.bytes_read != null) add("read", `${bytes(s.bytes_read_ever ?? s.bytes_read)} of ${bytes(s.bytes_file)}`, true);
    if (s.bytes_resident != null) {
      const {memory} = this.app.volume;
      add("memory", `${bytes(s.bytes_resident)}${memory ? ` of ${bytes(memory)}` : ""}`, true);
    }
    byId("numbers").replaceChildren(...parts);
    this.overlay(head);
    byId("status").title = "treelets: loaded since these values were chosen / active (what the picture can need) / in the file; " +
      "read: since the file was opened, a treelet twice counts twice; memory: resident treelets, of the budget";
  }
}
