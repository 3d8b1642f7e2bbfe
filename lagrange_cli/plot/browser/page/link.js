// The scene in the address of the page, after the #: m=1587&A=39032 ... &t=0.5.

import { INPUTS } from "../data.js";

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
