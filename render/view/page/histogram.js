// histogram.js - the plot of a field's histogram, on which isovalues and opacities are set.
import {element, short} from "./dom.js";

const TICK = 7, FOOT = 10; // pixels: of suggested values; below the bars

export class Plot {
  // colours(): a list of colours from low to high for the bars and over which values, or null
  constructor(host, colours = () => null) {
    this.host = host;
    this.colours = colours;
    this.canvas = element("canvas", {"aria-hidden": "true"});
    this.curve = null; // [[share of x, share of y], ...]
    this.ends = element("div", {class: "ends", "aria-hidden": "true"});
    host.replaceChildren(this.canvas, this.ends);
    new ResizeObserver(() => this.draw()).observe(host);
  }

  // Of a field at a step (stepOf()); the plot reaches over all steps.
  show(field, step, unit = "") {
    this.field = field;
    this.step = step;
    [this.low, this.high] = field.data;
    if (!(this.high > this.low)) this.high = this.low + 1;
    this.ends.replaceChildren(...field.data.map((v, i) => element("span", {}, i && unit ? `${short(v)} ${unit}` : short(v))));
    this.draw();
  }

  share(value) { return (value - this.low) / (this.high - this.low); }
  value(share) { return this.low + Math.min(1, Math.max(0, share)) * (this.high - this.low); }

  // Where a pointer is, as shares of the width and of the height above the foot.
  at(event) {
    const box = this.host.getBoundingClientRect();
    return [(event.clientX - box.left) / box.width, 1 - (event.clientY - box.top) / (box.height - FOOT)];
  }

  top(share) { return `calc(${100 * (1 - share)}% - ${FOOT * (1 - share)}px)`; }

  draw() {
    const ratio = window.devicePixelRatio || 1, {clientWidth, clientHeight} = this.host;
    if (!this.field || !clientWidth) return;
    const width = this.canvas.width = Math.round(clientWidth * ratio);
    const height = this.canvas.height = Math.round(clientHeight * ratio);
    const c = this.canvas.getContext("2d"), base = height - FOOT * ratio;
    this.bars(c, width, base);
    c.fillStyle = "#e3a94f";
    for (const v of this.step.suggested)
      c.fillRect(Math.round(this.share(v) * width - ratio), base + ratio, 2 * ratio, TICK * ratio);
    if (this.curve?.length) this.line(c, width, base, ratio);
  }

  bars(c, width, base) {
    const {edges, samples} = this.step.histogram;
    if (!samples.length) return;
    // A column of the plot shows the fullest bin that it touches; logarithms, since air is most of it.
    const columns = new Float64Array(width);
    samples.forEach((n, i) => {
      const a = Math.max(0, Math.floor(this.share(edges[i]) * width));
      const b = Math.min(width - 1, Math.max(a, Math.ceil(this.share(edges[i + 1]) * width) - 1));
      for (let x = a; x <= b; x++) columns[x] = Math.max(columns[x], n);
    });
    const most = Math.log1p(columns.reduce((a, b) => Math.max(a, b), 1)), found = this.colours();
    c.fillStyle = "#596171";
    for (let x = 0; x < width; x++) {
      const h = Math.log1p(columns[x]) / most * base * 0.94;
      if (found) {
        const t = (this.value(x / width) - found.low) / (found.high - found.low || 1);
        c.fillStyle = found.colours[Math.round(Math.min(1, Math.max(0, t)) * (found.colours.length - 1))];
        c.globalAlpha = 0.75;
      }
      c.fillRect(x, base - h, 1, h);
    }
    c.globalAlpha = 1;
  }

  line(c, width, base, ratio) {
    const at = ([x, y]) => [x * width, (1 - y) * base], points = this.curve.map(at);
    c.beginPath();
    c.moveTo(0, points[0][1]);
    for (const p of points) c.lineTo(...p);
    c.lineTo(width, points.at(-1)[1]);
    c.lineWidth = 3.5 * ratio;
    c.strokeStyle = "#000a";
    c.stroke();
    c.lineWidth = 1.5 * ratio;
    c.strokeStyle = "#fff";
    c.stroke();
  }
}

// drag() - a handle that a pointer or the arrow keys move. moved([x, y] or keys' [dx, dy], by keys, resting)
export function drag(handle, plot, moved) {
  handle.addEventListener("pointerdown", event => {
    handle.setPointerCapture(event.pointerId);
    handle.focus({preventScroll: true});
    event.preventDefault();
    event.stopPropagation();
    const on = e => moved(plot.at(e), false, false);
    const off = e => {
      handle.removeEventListener("pointermove", on);
      handle.removeEventListener("pointerup", off);
      handle.removeEventListener("pointercancel", off);
      if (e.type === "pointerup") moved(plot.at(e), false, true);
    };
    handle.addEventListener("pointermove", on);
    handle.addEventListener("pointerup", off);
    handle.addEventListener("pointercancel", off);
  });
  handle.addEventListener("keydown", event => {
    const way = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1]}[event.key];
    if (!way) return;
    event.preventDefault();
    const step = event.shiftKey ? 0.05 : 0.004;
    moved([way[0] * step, way[1] * step * 2.5], true, false);
  });
}
