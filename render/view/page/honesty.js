// honesty.js - the line that says what the picture is: exact or not, how far off, and what it took.
import {byId, bytes, element, short} from "./dom.js";

export class Honesty {
  constructor(app) { this.app = app; }

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
    byId("status").title = "treelets: loaded / active (what the picture can need) / in the file; " +
      "read: since the file was opened, a treelet twice counts twice; memory: resident treelets, of the budget";
  }
}
