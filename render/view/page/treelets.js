// treelets.js - the map of the volume's blocks: which treelets the picture can need, which of them are here.
import {element} from "./dom.js";

// Of the volume's own axes: what is across, what is down (turned, so that it rises), and what lies behind each other.
const SIDES = [["x", "y", 0, 1, 2], ["x", "z", 0, 2, 1], ["y", "z", 1, 2, 0]];
const UNIT = 6, GAP = 10, TEXT = 14; // pixels: of a block, between sides, of a side's name
export const NOTHING = [42, 46, 53], ABSENT = [227, 169, 79], HERE = [124, 196, 143];
export const SEEN = "#f4f6f8";

export const mix = (a, b = a, t = 0) => `rgb(${a.map((x, i) => Math.round(x + t * (b[i] - x)))})`;

// The blocks behind each other are added up.
function sums({blocks: n, wanted, resident, seen}, [, , across, down, behind]) {
  const out = [];
  for (let j = 0; j < n[down]; j++)
    for (let i = 0; i < n[across]; i++) {
      const sum = {i, j, wanted: 0, resident: 0, seen: 0}, at = [0, 0, 0];
      at[across] = i;
      at[down] = j;
      for (at[behind] = 0; at[behind] < n[behind]; at[behind]++) {
        const k = (at[2] * n[1] + at[1]) * n[0] + at[0];
        sum.wanted += wanted[k];
        sum.resident += resident[k];
        sum.seen += seen[k];
      }
      out.push(sum);
    }
  return out;
}

function drawSide(context, map, side, left) {
  const [across, down, a, b] = side, high = map.blocks[b];
  context.fillStyle = "#9aa1ac";
  context.fillText(`${across} →  ${down} ↑`, left, TEXT - 4);
  for (const s of sums(map, side)) {
    const x = left + UNIT * s.i, y = TEXT + UNIT * (high - 1 - s.j);
    context.fillStyle = s.wanted ? mix(ABSENT, HERE, s.resident / s.wanted) : mix(NOTHING);
    context.fillRect(x, y, UNIT - 1, UNIT - 1);
    if (!s.seen) continue;
    context.fillStyle = SEEN;
    context.fillRect(x + 1.5, y + 1.5, 2, 2);
  }
  return left + UNIT * map.blocks[a] + GAP;
}

export class Treelets {
  constructor() {
    this.canvas = element("canvas", {id: "treelets", role: "img", "aria-label": "No map yet"});
    this.text = element("p", {class: "hint"});
    this.box = element("div", {hidden: true}, this.canvas, this.text, element("p", {class: "hint"},
      "Green: here. Orange: to be read, should a ray need it. Grey: nothing to see. White dot: met by a ray."));
  }

  show(message) {
    const {map} = message, count = name => map[name].reduce((sum, n) => sum + n, 0);
    this.map = map;
    const ratio = window.devicePixelRatio || 1, size = [0, 1].map(k =>
      k ? TEXT + UNIT * Math.max(...SIDES.map(s => map.blocks[s[3]])) : SIDES.reduce((w, s) => w + UNIT * map.blocks[s[2]] + GAP, -GAP));
    this.canvas.width = Math.ceil(ratio * size[0]);
    this.canvas.height = Math.ceil(ratio * size[1]);
    this.canvas.style.width = `${size[0]}px`;
    const context = this.canvas.getContext("2d");
    context.scale(ratio, ratio);
    context.font = "11px system-ui, sans-serif";
    SIDES.reduce((left, side) => drawSide(context, map, side, left), 0);
    const part = count("wanted") ? Math.round(100 * count("resident") / count("wanted")) : 100;
    this.text.textContent = `Level ${map.level}: ${part} % of what this view can need is in memory.`;
    this.canvas.setAttribute("aria-label", this.text.textContent);
  }
}
