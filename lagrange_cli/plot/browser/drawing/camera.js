// The eye: an orthographic view of the unit sphere from an azimuth and an elevation.

export class Camera {
  constructor() {
    this.reset();
  }

  /** Look from where a top that starts to the front is seen best. */
  reset() {
    this.azimuth = -62;  // degrees; the axis starts towards -90
    this.elevation = 20;
    this.zoom = 1;
  }

  /** Turn by so many degrees; the eye never passes over a pole. */
  turn(right, up) {
    this.azimuth = (this.azimuth - right) % 360;
    this.elevation = Math.max(-90, Math.min(90, this.elevation + up));
  }

  magnify(factor) {
    this.zoom = Math.max(0.5, Math.min(400, this.zoom * factor));
  }

  /** The view on a canvas of this size; `centre` is the point of space in its middle. */
  view(width, height, centre = [0, 0, 0]) {
    const [azimuth, elevation] = [this.azimuth, this.elevation].map((x) => x * Math.PI / 180);
    const [sa, ca] = [Math.sin(azimuth), Math.cos(azimuth)];
    const [se, ce] = [Math.sin(elevation), Math.cos(elevation)];
    const right = [-sa, ca, 0];
    const up = [-se * ca, -se * sa, ce];
    const toward = [ce * ca, ce * sa, se];
    const scale = this.zoom * Math.min(width, height) / 2.6;
    const [x0, y0] = [dot3(centre, right), dot3(centre, up)];
    return {
      scale,
      project: (p) => [
        width / 2 + scale * (dot3(p, right) - x0),
        height * 0.515 - scale * (dot3(p, up) - y0),
      ],
      depth: (p) => dot3(p, toward),
    };
  }
}

function dot3(p, q) {
  return p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
}

function cross(p, q) {
  return [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]];
}

/** x p + y q + z r */
export function combined(x, p, y, q, z = 0, r = p) {
  return [0, 1, 2].map((i) => x * p[i] + y * q[i] + z * r[i]);
}

/** The frame of a body at its Euler angles: line of nodes, figure axis, and across both. */
export function frameOf({ theta, psi }) {
  const [st, ct] = [Math.sin(theta), Math.cos(theta)];
  const [sp, cp] = [Math.sin(psi), Math.cos(psi)];
  const nodes = [cp, sp, 0];
  const axis = [st * sp, -st * cp, ct];
  return { nodes, axis, across: cross(axis, nodes) };
}
