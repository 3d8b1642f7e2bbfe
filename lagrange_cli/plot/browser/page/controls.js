// The controls of time: play, pause, speed, step, and a jump to any time.  In closed form a jump
// costs no more than a step.  The controls of the inputs: a slider and a number field for each.
// All inputs and the time are in the address of the page after the #: m=1587&A=39032 ... &t=0.5.
// Mouse, touch and keys move the camera.

import { INPUTS } from "../data.js";
import { textOf } from "../drawing/canvas.js";
import { unitText } from "./record.js";

const FARTHEST = 1e15;

export class Clock {
  /** `changed()` is called when the time is set by hand. */
  constructor(page, changed) {
    this.page = page;
    this.changed = changed;
    this.t = 0;
    this.playing = false;
    this.period = 1;
    this.usual = 1;
    page.play.addEventListener("click", () => this.play(!this.playing));
    page.restart.addEventListener("click", () => this.set(0));
    page.back.addEventListener("click", (event) => this.step(-1, event.shiftKey));
    page.forward.addEventListener("click", (event) => this.step(1, event.shiftKey));
    page.scrub.addEventListener("input", () => this.set(Number(page.scrub.value)));
    page.time.addEventListener("change", () => this.setText(page.time.value));
    page.speed.addEventListener("input", () => this.showSpeed());
  }

  /** Scene time per second of the clock on the wall. */
  get speed() {
    return this.usual * 10 ** Number(this.page.speed.value);
  }

  /** Adapt to the period of a scene; `anew` also sets the usual speed. */
  adapt(period, anew) {
    this.period = period;
    if (!this.reaches(this.t)) this.t = 0;
    if (anew) this.usual = nice(period / 2.5);
    this.page.scrub.max = String(100 * period);
    this.page.scrub.step = String(period / 1000);
    this.showSpeed();
    this.show();
  }

  play(on) {
    this.playing = on;
    this.page.play.textContent = on ? "❚❚ Pause" : "▶ Play";
    this.page.play.setAttribute("aria-pressed", String(on));
    this.changed();
  }

  /** Go by a fiftieth of a period, or by a whole one. */
  step(direction, whole) {
    this.play(false);
    this.set(this.t + direction * this.period / (whole ? 1 : 50));
  }

  /** Whether a time is near enough for the angles to mean anything. */
  reaches(t) {
    return Math.abs(t) <= FARTHEST * this.period;
  }

  setText(text) {
    const t = numberOf(text);
    const fine = this.reaches(t);
    this.page.time.setAttribute("aria-invalid", String(!fine));
    if (fine) this.set(t);
  }

  set(t) {
    this.t = t;
    this.show();
    this.changed();
  }

  /** Let a part of a second pass. */
  pass(seconds) {
    if (!this.playing) return false;
    this.t += this.speed * seconds;
    this.show();
    return true;
  }

  show() {
    const { time, scrub } = this.page;
    const shown = this.t === 0 ? "0" : textOf(this.t, 7);
    if (document.activeElement !== time) time.value = shown;
    scrub.value = String(this.t);
    scrub.setAttribute("aria-valuetext", `t = ${shown}`);
  }

  showSpeed() {
    const text = `${textOf(this.speed, 2)} t/s`;
    this.page.speedShown.textContent = text;
    this.page.speed.setAttribute("aria-valuetext", text);
  }
}

/** The nearest of 1, 2, 5, 10, 20 ... */
function nice(x) {
  const power = 10 ** Math.floor(Math.log10(x));
  const lead = x / power;
  return (lead < 1.5 ? 1 : lead < 3.5 ? 2 : lead < 7.5 ? 5 : 10) * power;
}

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
      list.insertAdjacentHTML("beforeend", `<div class="input">
        <label for="field-${name}"><b>${input.symbol}</b> <span></span></label>
        <input id="field-${name}" type="text" inputmode="decimal" aria-describedby="error">
        <input id="slider-${name}" type="range" step="any" aria-label="${name}: ${input.name}">
      </div>`);
      const [label, field, slider] = list.lastElementChild.children;
      const take = () => changed(name, valueOf(name, field.value), field.value);
      field.addEventListener("change", take);
      slider.addEventListener("input", () => changed(name, rounded(slider), slider.value));
      slider.addEventListener("change", () => this.rescale(this.scene));
      this.fields[name] = { field, slider, name: label.lastElementChild };
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

/** Turn a camera by drag and arrows, zoom by pinch, wheel, + and -; each calls `moved()`. */
export function followHands(canvas, camera, moved) {
  const fingers = new Map();
  const spread = () => {
    const [p, q] = [...fingers.values()];
    return Math.hypot(p.x - q.x, p.y - q.y);
  };
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture?.(event.pointerId);
    fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
  });
  canvas.addEventListener("pointermove", (event) => {
    const last = fingers.get(event.pointerId);
    if (!last) return;
    const before = fingers.size === 2 ? spread() : 0;
    fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    if (fingers.size === 2) camera.magnify(spread() / Math.max(before, 1));
    else camera.turn((event.clientX - last.x) * 0.5, (event.clientY - last.y) * 0.5);
    moved();
  });
  for (const end of ["pointerup", "pointercancel"]) {
    canvas.addEventListener(end, (event) => fingers.delete(event.pointerId));
  }
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    camera.magnify(Math.exp(-event.deltaY / 500));
    moved();
  }, { passive: false });
  canvas.addEventListener("dblclick", () => {
    camera.reset();
    moved();
  });
  const moves = {
    ArrowLeft: () => camera.turn(-5, 0),
    ArrowRight: () => camera.turn(5, 0),
    ArrowUp: () => camera.turn(0, 5),
    ArrowDown: () => camera.turn(0, -5),
    "+": () => camera.magnify(1.2),
    "-": () => camera.magnify(1 / 1.2),
    0: () => camera.reset(),
  };
  canvas.addEventListener("keydown", (event) => {
    if (actOnKey(event, moves)) moved();
  });
}

/** Run the action that a table has for the key of an event; return whether it has one. */
export function actOnKey(event, actions) {
  if (!actions[event.key]) return false;
  event.preventDefault();
  event.stopPropagation();
  actions[event.key]();
  return true;
}
