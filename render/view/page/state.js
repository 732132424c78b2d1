// state.js - what is to be drawn.
//
// The page works on a model with what flags cannot say: surfaces that are off (some so that the volume is seen: covered),
// lights as angles. The protocol, files and the address hold flags: the keys of `leafcast render` without their dashes.
import {annotationFlags, annotationOf} from "./annotate.js";
import {slicesOf, slicesPage} from "./slice.js";
import {add, dot, length, scale, sub, unit} from "./vector.js";

export const COLOURS = ["#e3c08a", "#7fb2e5", "#8fce9b", "#e58f8f", "#c3a1e8", "#e6e6e6", "#e8a15c", "#6fd0cf"];
export const UNIT_MAX = 12, SURFACES_MAX = 16, LIGHTS_MAX = 8, PLANES_MAX = 8, FOV = 35;
const DRAWN_BY_MAX = ["max", "min", "mean", "first"];

// One value a ray, and no surfaces.
export const isProjected = v => DRAWN_BY_MAX.includes(v.mode);

const rgb = text => [1, 3, 5].map(i => parseInt(text.slice(i, i + 2), 16) / 255);
const linear = x => x <= 0.04045 ? x / 12.92 : ((x + 0.055) / 1.055) ** 2.4;
const encoded = x => x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055;
const hex = c => "#" + c.map(x => Math.round(255 * Math.min(1, Math.max(0, encoded(x)))).toString(16).padStart(2, "0"))
  .join("");

// A colour's flag as #rrggbb, if it is that or linear numbers; else what is given instead.
function hexOf(value, otherwise) {
  if (Array.isArray(value)) return hex(value.slice(0, 3).map(Number));
  if (/^#[0-9a-f]{6}/i.test(value)) return value.slice(0, 7).toLowerCase();
  const numbers = String(value).split(",").map(Number);
  return numbers.length >= 3 && numbers.every(Number.isFinite) ? hex(numbers.slice(0, 3)) : otherwise;
}

const numbers = value => (Array.isArray(value) ? value : String(value).split(",")).map(Number);
// Several values of a flag that takes a vector: [[..], [..]], or one.
const vectors = value => value == null ? [] : Array.isArray(value) && (Array.isArray(value[0]) || typeof value[0] === "string")
  ? value.map(numbers) : [numbers(value)];
const list = value => value == null ? [] : Array.isArray(value) ? value : [value];

export function diagonal(volume) {
  return length(sub(volume.bounds[1], volume.bounds[0])) || 1;
}

export function centre(volume) {
  return scale(add(volume.bounds[0], volume.bounds[1]), 0.5);
}

// ---- flags to the model ----

function cameraOf(flags, volume) {
  const first = volume.state;
  const get = (key, other) => numbers(flags[key] ?? first[key] ?? other);
  const lookAt = get("look-at", centre(volume)), fov = +(flags.fov ?? (flags.ortho ? FOV : first.fov ?? FOV));
  let eye = get("eye", [1, 1, 1]);
  if (flags.ortho) {
    // The distance of the camera in perspective that sees as much at the point looked at.
    const distance = +flags.ortho / (2 * Math.tan(fov * Math.PI / 360));
    eye = add(lookAt, scale(unit(sub(eye, lookAt)), distance));
  }
  return {eye, lookAt, up: get("up", [0, 0, 1]), fov, ortho: Boolean(flags.ortho)};
}

function lightOf(l, point) {
  const colour = l.length >= 6 ? hex(l.slice(3, 6)) : "#ffffff";
  const u = unit(l.slice(0, 3));
  // The last of four or seven numbers is how wide the light is, for soft shadows.
  return {point: point ? l.slice(0, 3) : null, radius: l.length % 3 === 1 ? l.at(-1) : 0, colour, azimuth: Math.atan2(u[1], u[0]) * 180 / Math.PI,
    elevation: Math.asin(Math.max(-1, Math.min(1, u[2]))) * 180 / Math.PI,
    exact: point ? null : l.slice(0, 3)};
}

function volumeOf(flags, curve) {
  const project = flags.project ?? "", custom = curve.length > 0;
  const mode = project ? project.split("=")[0] : flags.tf || custom || flags["colour-map"] ? "media" : "off";
  return {mode, preset: custom || !flags.tf ? (mode === "media" && !custom ? "auto" : custom ? "custom" : "auto") : flags.tf,
    map: flags["colour-map"] ?? flags["color-map"] ?? "", points: curve,
    window: flags.window ? numbers(flags.window) : null, length: flags["opacity-length"] ? +flags["opacity-length"] : null,
    first: project.startsWith("first=") ? +project.slice(6) : null};
}

function unseenOf(page, projected) {
  const given = Array.isArray(page?.surfaces) ? page.surfaces : [];
  return given.filter(s => Number.isFinite(s?.iso)).map(({iso, colour, color, opacity, on, covered}) =>
    ({iso, color: hexOf(colour ?? color, "#ffffff"), opacity: opacity > 0 && opacity <= 1 ? opacity : 1,
      on: on === true && !projected, covered: covered === true || (on === true && projected)}));
}

// Of values, by their fields' names.
function unitsOf(page) {
  const given = page?.units && typeof page.units === "object" ? page.units : {};
  return Object.fromEntries(Object.entries(given).filter(([, u]) => typeof u === "string").map(([k, u]) => [k, u.slice(0, UNIT_MAX)]));
}

export function fromFlags(given, volume) {
  const flags = {};
  for (const [key, value] of Object.entries(given)) flags[key.replaceAll("_", "-")] = value;
  Object.assign(flags, flags.camera ?? {});
  const colours = list(flags.colour ?? flags.color), curve = [], opacities = [], reflects = list(flags.reflect),
    refracts = list(flags.refract);
  for (const o of list(flags.opacity))
    if (String(o).includes(":")) for (const p of String(o).split(",")) curve.push(p.split(":").map(Number));
    else opacities.push(+o);
  const isos = volume.surface ? [0] : list(flags.iso ?? flags.isovalues).flatMap(v => String(v).split(",").map(Number));
  const background = flags.project && flags.background === groundOf(flags["colour-map"], volume) ? null : flags.background;
  const field = volume.fields.findIndex((f, i) => f.name === flags.field || String(i) === String(flags.field));
  const f = volume.fields[Math.max(0, field)];
  return {
    camera: cameraOf(flags, volume),
    surfaces: [...isos.filter(v => volume.surface || v !== nowhere(f)).map((iso, i) =>
      ({iso, color: hexOf(colours[i] ?? COLOURS[i % COLOURS.length], "#ffffff"), opacity: opacities[i] ?? 1, on: true,
        ...reflects[i] != null && {reflect: reflects[i]}, ...refracts[i] != null && {refract: refracts[i]}})),
      ...volume.surface ? [] : unseenOf(flags.page, Boolean(flags.project))].slice(0, SURFACES_MAX),
    volume: volumeOf(flags, curve),
    clip: {box: flags["clip-box"] ? numbers(flags["clip-box"]) : null,
      planes: vectors(flags["clip-plane"]).map(p => ({plane: p, on: true})),
      caps: flags.caps == null ? "off" : flags.caps === true ? "" : flags.caps},
    light: {lights: [...vectors(flags.light).map(l => lightOf(l, false)),
      ...vectors(flags["point-light"]).map(l => lightOf(l, true))],
      shadows: flags.shadows === true, ambient: +(flags.ambient ?? 0.15), shading: flags.shading ?? "diffuse",
      specular: +(flags.specular ?? 0.3), shininess: +(flags.shininess ?? 32), normals: flags.normals ?? "",
      samples: +(flags.samples ?? 1), background: background == null ? null : hexOf(background, "#000000"),
      clear: background != null && (numbers(background)[3] === 0 || /^#[0-9a-f]{6}00$/i.test(background))},
    data: {field: Math.max(0, field), step: +(flags.step ?? 0)},
    annotation: annotationOf(flags),
    slices: slicesOf(flags.page, volume),
    units: unitsOf(flags.page),
    legend: flags.legend === true,
    more: Object.fromEntries(Object.entries(flags).filter(([k]) => ["error", "homogeneous", "lod", "layers"].includes(k))),
  };
}

// ---- the model to flags ----

// A value that may stand for missing data: the end of the range that the data leave aside. null: none.
export function asideOf({range, data}) {
  const side = range.findIndex((v, i) => v !== data[i]);
  return side < 0 ? null : range[side];
}

// What is told of a field at a step. Of late steps nothing is: that of the first one then, but for its presets.
export function stepOf(field, step) {
  return field.steps[step] ?? {...field.steps[0], presets: {}};
}

// The unit of a field's values: as it is said on this page, or as the field's name ends: "speed [m/s]", "T (K)". "": unknown.
export function valueUnit(field, model) {
  return model.units[field.name] ?? field.name.match(/[[(]([^\])]{1,12})[\])]\s*$/)?.[1] ?? "";
}

// The unit of lengths: as it is said for the picture, or the file's, where all axes have the same.
export function lengthUnit(volume, model) {
  return model.annotation.unit || (volume.units.every(u => u === volume.units[0]) ? volume.units[0] : "");
}

// An isovalue that no sample has: without any, one would be suggested and drawn.
export function nowhere(field) {
  return field.range[1] + Math.max(1, field.range[1] - field.range[0]);
}

function cameraFlags(camera, volume) {
  const away = sub(camera.eye, camera.lookAt), distance = length(away);
  if (!camera.ortho) return {eye: camera.eye, "look-at": camera.lookAt, up: camera.up, fov: camera.fov};
  // Parallel rays begin at the eye: it stands before all of the volume.
  const back = Math.max(distance, diagonal(volume) + length(sub(camera.lookAt, centre(volume))));
  return {eye: add(camera.lookAt, scale(away, back / distance)), "look-at": camera.lookAt, up: camera.up,
    ortho: 2 * distance * Math.tan(camera.fov * Math.PI / 360)};
}

export function direction(light) {
  if (light.point) return light.point;
  if (light.exact) return light.exact;
  const a = light.azimuth * Math.PI / 180, e = light.elevation * Math.PI / 180;
  return [Math.cos(e) * Math.cos(a), Math.cos(e) * Math.sin(a), Math.sin(e)];
}

function lightFlags(light, flags) {
  const radius = l => light.shadows && l.radius ? [l.radius] : [];
  const vector = l => [...direction(l), ...(l.colour === "#ffffff" ? [] : rgb(l.colour).map(linear)), ...radius(l)];
  const far = light.lights.filter(l => !l.point).map(vector), near = light.lights.filter(l => l.point).map(vector);
  if (far.length) flags.light = far;
  if (near.length) flags["point-light"] = near;
  if (light.shadows && light.lights.length) flags.shadows = true;
  if (light.ambient !== 0.15) flags.ambient = light.ambient;
  if (light.shading !== "diffuse") flags.shading = light.shading;
  if (light.shading === "phong") Object.assign(flags, {specular: light.specular, shininess: light.shininess});
  if (light.normals) flags.normals = light.normals;
  if (light.samples > 1) flags.samples = light.samples;
  if (light.clear) flags.background = "0,0,0,0";
  else if (light.background) flags.background = light.background;
}

// What colours are spread over, if that is to be said: of steps the same for all, as the first is not the range of others.
export function windowOf(window, field, volume) {
  return window ?? (volume.steps.length > 1 && field.data[1] > field.data[0] ? field.data : null);
}

function volumeFlags(v, volume, field, flags) {
  if (v.mode === "off") return;
  const window = windowOf(v.window, field, volume);
  if (DRAWN_BY_MAX.includes(v.mode)) {
    flags.project = v.mode === "first" ? `first=${v.first}` : v.mode;
    flags["colour-map"] = v.map || "grey";
    if (window) flags.window = window;
    return;
  }
  if (v.preset !== "custom") flags.tf = v.preset;
  else {
    flags.opacity = [...flags.opacity ?? [], v.points.map(p => p.join(":")).join(",")];
    if (v.length) flags["opacity-length"] = v.length;
  }
  if (v.map || v.preset === "custom") {
    flags["colour-map"] = v.map || "viridis";
    if (window) flags.window = window;
  }
}

// What changes no picture, and is to come back with the rest. unseen: surfaces that are not drawn.
function pageFlags(model, unseen) {
  const slices = slicesPage(model.slices);
  const surfaces = unseen.map(({iso, color, opacity, on, covered}) =>
    ({iso, colour: color, opacity, on, ...covered && {covered}}));
  const page = {...slices && {slices}, ...surfaces.length && {surfaces},
    ...Object.keys(model.units).length && {units: model.units}};
  return Object.keys(page).length ? {page} : {};
}

// Whether flags fill an object with a medium, beside which nothing refracts. surface: it is one itself, which they colour.
export function hasMedium(flags, surface) {
  const has = name => Object.keys(flags).some(key => name.test(key.replaceAll("_", "-")));
  return !surface && !has(/^colou?r-by$/) && (has(/^(tf|colou?r-map|window|opacity-length)$/) ||
    list(flags.opacity).some(o => String(o).includes(":")));
}

// The flags of one volume, and of projections.
export function flagsOfOne(model, volume) {
  const flags = {}, field = volume.fields[model.data.field], on = model.surfaces.filter(s => s.on);
  const projected = DRAWN_BY_MAX.includes(model.volume.mode);
  if (volume.fields.length > 1 && model.data.field > 0) flags.field = String(model.data.field);
  if (model.data.step > 0) flags.step = model.data.step;
  if (!projected && on.length) {
    if (!volume.surface) flags.iso = on.map(s => s.iso);
    flags.colour = on.map(s => s.color);
    if (on.some(s => s.opacity < 1)) flags.opacity = on.map(s => s.opacity);
    if (on.some(s => s.reflect != null)) flags.reflect = on.map(s => String(s.reflect ?? 0));
    if (on.some(s => s.refract != null) && on.some(s => s.opacity < 1)) // else it would change nothing
      flags.refract = on.map(s => String(s.refract ?? 1));
  } else if (!projected && model.volume.mode === "off") flags.iso = [nowhere(field)];
  volumeFlags(model.volume, volume, field, flags);
  return Object.assign(flags, pageFlags(model, model.surfaces.filter(s => projected || !s.on)));
}

// The flags of the picture. world: the volume, or what stands for all objects of a scene. caps, legend: there is what
// they can be of.
export function flagsOfPicture(model, world, caps, legend) {
  const flags = {}, planes = model.clip.planes.filter(p => p.on).map(p => p.plane);
  if (model.clip.box) flags["clip-box"] = model.clip.box;
  if (planes.length) flags["clip-plane"] = planes;
  if (model.clip.caps !== "off" && caps && (planes.length || model.clip.box)) flags.caps = model.clip.caps || true;
  Object.assign(flags, cameraFlags(model.camera, world));
  lightFlags(model.light, flags);
  if (model.legend && legend) flags.legend = true;
  return Object.assign(flags, annotationFlags(model.annotation), model.more);
}

// What lies around a projection unless something is said: the colour of least, which air has.
const groundOf = (map, volume) => volume.colour_maps[map || "grey"]?.[0];

export function toFlags(model, volume) {
  const projected = DRAWN_BY_MAX.includes(model.volume.mode), caps = !volume.surface && !projected &&
    model.surfaces.some(s => s.on);
  const ground = projected && !model.light.clear && !model.light.background ? {background: groundOf(model.volume.map, volume)} : {};
  const {refract, ...flags} = flagsOfOne(model, volume);
  return {...ground, ...flags, ...refract && !hasMedium(flags, volume.surface) && {refract},
    ...flagsOfPicture(model, volume, caps, model.volume.mode !== "off")};
}

// ---- as a line for a shell ----

const quoted = text => /^[\w.,:=#+\/-]+$/.test(text) && !text.startsWith("#") ? text : `'${text.replaceAll("'", "'\\''")}'`;
const REPEATED = ["iso", "colour", "opacity", "reflect", "refract", "light", "point-light", "clip-plane"];

// A name that nothing has which another command has written: with the moment at which it is copied. So --force overwrites
// nothing but what the same command wrote before.
let stamped = "", copies = 0;

export function freeStem(stem) {
  const digits = n => String(n).padStart(2, "0"), t = new Date();
  const stamp = [t.getFullYear(), digits(t.getMonth() + 1), digits(t.getDate()), "-", digits(t.getHours()), digits(t.getMinutes()),
    digits(t.getSeconds())].join("");
  copies = stamp === stamped ? copies + 1 : 1;
  stamped = stamp;
  return `${stem}-${stamp}${copies > 1 ? `-${copies}` : ""}`;
}

// file: its path, as the server was given it. stem: of the picture's name; null: whoever asks goes on.
export function command(flags, file, width, height, verb = "render", stem = verb === "slice" ? "slice" : "picture") {
  const words = ["leafcast", verb, quoted(file.startsWith("-") ? "./" + file : file)];
  const word = (key, value) => words.push(quoted(`--${key}=${Array.isArray(value) ? value.join(",") : value}`));
  for (const [key, value] of Object.entries(flags)) {
    if (key === "page") continue; // what is not the picture's
    if (value === true) words.push(`--${key}`);
    else if (REPEATED.includes(key) && Array.isArray(value)) value.forEach(v => word(key, v));
    else if (value !== false) word(key, value);
  }
  return [...words, `--size=${width}x${height}`, ...stem ? ["-o", `${freeStem(stem)}.png`, "--force"] : []].join(" ");
}

// ---- the address ----

export function toFragment(flags, file) {
  const text = encodeURIComponent(JSON.stringify(file ? {...flags, file} : flags));
  return "#" + text.replace(/%(22|5B|5D|2C|3A|7B|7D)/g, decodeURIComponent);
}

// What the address holds, or null. Numbers, text, lists: what else there is, the server refuses.
export function fromFragment(fragment) {
  try {
    const flags = JSON.parse(decodeURIComponent(fragment.replace(/^#/, "")));
    return flags && typeof flags === "object" && !Array.isArray(flags) ? flags : null;
  } catch {
    return null;
  }
}
