// Scenes to begin with.

const CHRAPAN = {
  m: 1587, A: 39032, C: 17458, s: 4, g: 981, r0: 50, theta0_deg: 30, thetadot0: 0, psidot0: 0,
};
const UNIT = {
  m: 1, A: 1, C: 1, s: 1, g: 1, r0: 1, theta0_deg: 90, thetadot0: 0, psidot0: 0,
};
const GYROSCOPE = { ...CHRAPAN, m: 0.35, A: 8.5e-4, C: 4e-4, s: 0.03, g: 9.81 };

export const EXAMPLES = {
  "Cusps: let go at rest (Chrapan 1952)": CHRAPAN,
  "Loops: started against its precession": { ...CHRAPAN, psidot0: -4 },
  "Waves: started along its precession": { ...CHRAPAN, psidot0: 4 },
  "Steady precession": { ...UNIT, psidot0: 1 },
  "Fast gyroscope": { ...GYROSCOPE, r0: 1256.6370614359172, theta0_deg: 60 },
  "Slow top: falls nearly to the bottom": { ...CHRAPAN, r0: 5, theta0_deg: 20 },
  "Sleeping": { ...CHRAPAN, r0: 60, theta0_deg: 0 },
  "Too slow to sleep: waits, and falls": { ...CHRAPAN, theta0_deg: 1e-3 },
  "Separatrix: rises for ever": { ...UNIT, A: 2, r0: 0, thetadot0: -1 },
  "Hanging and swinging": { ...CHRAPAN, r0: 10, theta0_deg: 150 },
  "Hanging straight down": { ...CHRAPAN, r0: 10, theta0_deg: 180 },
  "Spherical pendulum": { ...CHRAPAN, r0: 0, theta0_deg: 120, psidot0: 9 },
  "Plane pendulum": { ...CHRAPAN, r0: 0, theta0_deg: 120 },
  "Without torque": { ...CHRAPAN, g: 0, psidot0: 8 },
};
