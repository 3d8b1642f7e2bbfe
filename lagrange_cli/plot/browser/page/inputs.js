// The inputs: a slider and a number field for each; and all of them, with the time, in the address
// of the page after the #: m=1587&A=39032 ... &t=0.5.

import { INPUTS } from "../data.js";
import { unitText } from "./record.js";

/** The range of a slider about a value. */
function rangeOf(name, scene) {
  const x = scene[name];
  switch (name) {
    case "theta0_deg": return [0, 180];
    case "C": return [0.02 * scene.A, 2 * scene.A];
    case "A": return [scene.C / 2, Math.max(3 * x, scene.C)];
    case "m": return [0.05 * x, 3 * x];
    case "s": case "g": return [0, 3 * x || 1];
    case "r0": return spread(x, 2.5 * Math.sqrt(Math.max(fall(scene), 1e-30)) * scene.A / scene.C);
    default: return spread(x, Math.sqrt(fall(scene)) || 1);
  }
}

/** 2mgs/A, whose root is the rate at which the top falls. */
function fall({ m, g, s, A }) {
  return 2 * m * g * s / A;
}

function spread(x, usual) {
  const half = Math.max(1.5 * Math.abs(x), usual);
  return [-half, half];
}

/** Build the controls in a list; `changed(name, value, text)` is called for each change. */
export class Inputs {
  constructor(list, changed) {
    this.fields = {};
    for (const [name, input] of Object.entries(INPUTS)) {
      const row = document.createElement("div");
      row.className = "input";
      const label = document.createElement("label");
      label.htmlFor = `field-${name}`;
      label.innerHTML = `<b>${input.symbol}</b> <span></span>`;
      const field = document.createElement("input");
      Object.assign(field, { id: `field-${name}`, type: "text", inputMode: "decimal" });
      field.setAttribute("aria-describedby", "error");
      const slider = document.createElement("input");
      Object.assign(slider, { id: `slider-${name}`, type: "range", step: "any" });
      slider.setAttribute("aria-label", `${name}: ${input.name}`);
      row.append(label, field, slider);
      list.append(row);
      const take = () => changed(name, valueOf(name, field.value), field.value);
      field.addEventListener("change", take);
      slider.addEventListener("input", () => changed(name, rounded(slider), slider.value));
      slider.addEventListener("change", () => this.rescale(this.scene));
      this.fields[name] = { field, slider, name: label.lastChild };
    }
  }

  /** Write the units of a scene beside the names. */
  nameUnits(units) {
    for (const [key, { name }] of Object.entries(this.fields)) {
      const unit = unitText(INPUTS[key].unit, units);
      name.textContent = `${INPUTS[key].name}${unit && ` (${unit})`}`;
    }
  }

  /** Show the values of a scene; the ranges of the sliders stay until `rescale`. */
  show(scene) {
    this.scene = scene;
    for (const [name, { field, slider }] of Object.entries(this.fields)) {
      field.value = String(scene[name]);
      slider.value = String(scene[name]);
      slider.setAttribute("aria-valuetext", String(scene[name]));
    }
  }

  /** Give each slider a range about its value. */
  rescale(scene) {
    for (const [name, { slider }] of Object.entries(this.fields)) {
      const [low, high] = rangeOf(name, scene);
      [slider.min, slider.max] = [String(low), String(high)];
    }
    this.show(scene);
  }

  /** Mark the input that an error names, or none. */
  mark(message) {
    for (const [name, { field }] of Object.entries(this.fields)) {
      field.setAttribute("aria-invalid", String(message.startsWith(`${name} `)));
    }
  }
}

/** The value of an input that a text stands for, or NaN; rates may be in turns per minute. */
function valueOf(name, text) {
  const rate = INPUTS[name].unit === "rad/time" && text.match(/^(.*[^ ]) *rpm$/i);
  return rate ? Number((numberOf(rate[1]) * Math.PI / 30).toPrecision(15)) : numberOf(text);
}

/** The number that a text stands for, or NaN. */
export function numberOf(text) {
  return text.trim() === "" ? NaN : Number(text.replace("−", "-").replace(",", "."));
}

/** A slider's value with the digits that its steps tell apart; 0 and the ends are met exactly. */
function rounded(slider) {
  const [value, low, high] = [slider.value, slider.min, slider.max].map(Number);
  const step = 10 ** Math.floor(Math.log10((high - low) / 300));
  if (value <= low + step / 2 || value >= high - step / 2) return value;
  return Number((Math.round(value / step) * step).toPrecision(12));
}

/** The inputs, and the time, that an address carries.  Raises RangeError for what is no number. */
export function readLink(fragment) {
  const found = {};
  for (const [name, text] of new URLSearchParams(fragment.replace(/^#/, ""))) {
    const known = Object.hasOwn(INPUTS, name) || name === "t";
    if (!known) throw new RangeError(`no input is called ${name}`);
    const x = text.trim() === "" ? NaN : Number(text);
    if (!Number.isFinite(x)) throw new RangeError(`${name} must be a number, got ${text}`);
    found[name] = x;
  }
  return found;
}

/** The address that carries a scene and a time. */
export function linkOf(scene, t) {
  const words = Object.keys(INPUTS).map((name) => `${name}=${scene[name]}`);
  return `#${words.join("&")}&t=${Number(t.toPrecision(12))}`;
}

/** Put the scene into the address bar; a page inside another one has none. */
export function showLink(scene, t) {
  try {
    history.replaceState(null, "", linkOf(scene, t));
  } catch {
    // a page in a notebook
  }
}
