// dom.js - elements, and the controls that the panel is made of.

export const byId = id => document.getElementById(id);

// element("button", {class: "icon", onclick: f}, "text", child...) - properties of "on..." are listeners.
export function element(tag, attributes = {}, ...children) {
  const e = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on")) e.addEventListener(name.slice(2), value);
    else if (value === true) e.setAttribute(name, "");
    else if (value !== false && value != null) e.setAttribute(name, value);
  }
  e.append(...children.filter(c => c != null));
  return e;
}

// The shortest text with so many digits; with all that are before the point, unless these are many.
export function short(x, digits = 4) {
  if (!Number.isFinite(x)) return "–";
  const whole = Math.floor(Math.log10(Math.abs(x) || 1)) + 1;
  const text = whole > 7 ? (+x.toPrecision(digits)).toExponential().replace("e+", "e")
    : String(+x.toPrecision(Math.max(digits, whole)));
  return text.replaceAll("-", "−");
}

// Of a number, as much as a small box shows.
export function brief(x) {
  const text = String(+x.toPrecision(6));
  return text.length <= 8 ? text : x.toExponential(3).replace("e+", "e");
}

export function bytes(n) {
  const units = ["B", "KiB", "MiB", "GiB", "TiB"];
  let u = 0;
  for (; n >= 1024 && u + 1 < units.length; u++) n /= 1024;
  return `${u ? n.toFixed(n < 10 ? 1 : 0) : n} ${units[u]}`;
}

// slider() - a range with its number beside it; change(value, resting). Its set(value) shows another value,
// its extend(max) lets it go further.
export function slider(label, {min, max, step = "any", value, change}) {
  const range = element("input", {type: "range", min, max, step, "aria-label": label});
  const number = element("input", {type: "number", min, max, step: "any", "aria-label": `${label}, number`});
  const row = element("div", {class: "field"}, element("span", {}, label), range, number);
  row.set = v => { range.value = v; number.value = +(+v).toPrecision(6); };
  row.extend = to => { max = range.max = number.max = to; };
  range.addEventListener("input", () => { row.set(range.value); change(+range.value, false); });
  range.addEventListener("change", () => change(+range.value, true));
  number.addEventListener("change", () => {
    const v = Math.min(max, Math.max(min, +number.value));
    if (number.value === "" || !Number.isFinite(v)) return row.set(range.value);
    row.set(v);
    change(v, true);
  });
  row.set(value);
  return row;
}

// choice() - a select of [value, text] pairs; change(value).
export function choice(label, {options, value, change}) {
  const select = element("select", {"aria-label": label},
    ...options.map(([v, text]) => element("option", {value: v}, text)));
  select.value = value;
  select.addEventListener("change", () => change(select.value));
  const row = element("label", {class: "field"}, element("span", {}, label), select);
  row.set = v => { select.value = v; };
  return row;
}

export function check(label, {value, change}) {
  const box = element("input", {type: "checkbox"});
  box.checked = value;
  box.addEventListener("change", () => change(box.checked));
  const row = element("label", {class: "check"}, box, label);
  row.set = v => { box.checked = v; };
  return row;
}

export function colour(label, {value, change}) {
  const input = element("input", {type: "color", value, "aria-label": label, title: label});
  input.addEventListener("input", () => change(input.value, false));
  input.addEventListener("change", () => change(input.value, true));
  return input;
}

// span() - two handles on one track, and their numbers; change([low, high], resting).
export function span(label, {min, max, value, change}) {
  const step = (max - min) / 1000 || 1;
  const fill = element("i");
  const ends = ["from", "to"].map((word, k) =>
    element("input", {type: "range", min, max, step: "any", "aria-label": `${label} ${word}`}));
  const numbers = ["from", "to"].map(word =>
    element("input", {type: "number", min, max, step: "any", class: word, "aria-label": `${label} ${word}, number`}));
  const show = () => {
    const [a, b] = ends.map(e => (+e.value - min) / (max - min || 1));
    fill.style.left = `${100 * a}%`;
    fill.style.right = `${100 * (1 - b)}%`;
    ends.forEach((e, k) => { numbers[k].value = brief(+e.value); });
    // The handle that can still move lies on top.
    ends[0].style.zIndex = a > 0.5 ? 2 : 1;
    ends[1].style.zIndex = a > 0.5 ? 1 : 2;
  };
  const changed = (k, resting) => {
    if (+ends[0].value > +ends[1].value) ends[k].value = ends[1 - k].value;
    show();
    change(ends.map(e => +e.value), resting);
  };
  ends.forEach((e, k) => {
    e.addEventListener("input", () => changed(k, false));
    e.addEventListener("change", () => changed(k, true));
    // Arrow keys of a range with any step go by hundredths; finer here.
    e.addEventListener("keydown", event => {
      const way = {ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1}[event.key];
      if (!way) return;
      event.preventDefault();
      e.value = +e.value + way * step * (event.shiftKey ? 50 : 5);
      changed(k, true);
    });
  });
  numbers.forEach((n, k) => n.addEventListener("change", () => {
    if (n.value === "" || !Number.isFinite(+n.value)) return show();
    ends[k].value = +n.value;
    changed(k, true);
  }));
  const row = element("div", {class: "field pair"}, element("span", {}, label),
    element("div", {class: "span"}, fill, ...ends), ...numbers);
  row.set = v => { ends.forEach((e, k) => { e.value = v[k]; }); show(); };
  row.set(value);
  return row;
}
