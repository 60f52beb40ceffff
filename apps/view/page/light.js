// The ball by which the key light is turned: option light-direction, azimuth and elevation as seen from the camera.
// Inside the ball the light is on the camera's side; the ring around it is the far side.
import { element } from "./dom.js";
import { clamp, degrees, radians } from "./math.js";

const kBall = 0.74; // radius of the ball in the ring

/// Returns azimuth and elevation in degrees at a place, -1 to 1 with y up.
export function light_at(x, y) {
  const r = Math.min(1, Math.hypot(x, y)) || 1e-6;
  const sine = r <= kBall ? r / kBall : (1 - r) / (1 - kBall);
  const px = (x / Math.hypot(x, y || 1e-9)) * sine || 0,
    py = (y / Math.hypot(x || 1e-9, y)) * sine || 0;
  const z = Math.sqrt(Math.max(0, 1 - sine * sine)) * (r <= kBall ? 1 : -1);
  return [degrees(Math.atan2(px, z)), degrees(Math.asin(clamp(py, -1, 1)))];
}

/// Returns the direction to the light: x right, y up, z to the camera.
export function light_direction(azimuth_deg, elevation_deg) {
  const a = radians(azimuth_deg),
    e = radians(elevation_deg);
  return [Math.sin(a) * Math.cos(e), Math.sin(e), Math.cos(a) * Math.cos(e)];
}

function place_of_light([x, y, z]) {
  const sine = Math.min(1, Math.hypot(x, y)),
    r = z >= 0 ? sine * kBall : 1 - sine * (1 - kBall);
  return sine > 1e-6 ? [(x / sine) * r, (y / sine) * r] : [0, z >= 0 ? 0 : 1];
}

function draw_ball(canvas, direction, is_set) {
  const size = canvas.width,
    pen = canvas.getContext("2d"),
    image = pen.createImageData(size, size);
  const style = getComputedStyle(canvas),
    is_dark = style.getPropertyValue("--is-dark").trim() === "1";
  const half = size / 2;
  for (let y = 0; y < size; ++y) {
    for (let x = 0; x < size; ++x) {
      const px = (x + 0.5 - half) / half,
        py = (half - y - 0.5) / half,
        r = Math.hypot(px, py);
      const edge = clamp((1 - r) * half, 0, 1),
        at = 4 * (y * size + x);
      let level = is_dark ? 44 : 226,
        alpha = edge * 255;
      const inside = clamp((kBall - r) * half + 0.5, 0, 1);
      if (inside > 0) {
        const nx = px / kBall,
          ny = py / kBall,
          nz = Math.sqrt(Math.max(0, 1 - nx * nx - ny * ny));
        const lit = Math.max(0, nx * direction[0] + ny * direction[1] + nz * direction[2]);
        const shade = 255 * Math.sqrt(0.035 + 0.1 * (0.5 + 0.5 * ny) + 0.8 * lit);
        level = level * (1 - inside) + shade * inside;
      }
      image.data.set([level, level, level, alpha], at);
    }
  }
  pen.putImageData(image, 0, 0);
  const [x, y] = place_of_light(direction);
  pen.beginPath();
  pen.arc(half + x * half, half - y * half, size * 0.045, 0, 7);
  pen.fillStyle = is_set ? "#ffb000" : "#ffb00099";
  pen.fill();
  pen.lineWidth = size * 0.016;
  pen.strokeStyle = "#5b3f00";
  pen.stroke();
}

/// Makes the ball. `access`: get() and set(text, moving) of light-direction. Returns {root, refresh}.
export function light_ball(access) {
  const canvas = element("canvas", {
    class: "ball",
    width: 176,
    height: 176,
    tabindex: 0,
    role: "slider",
    "data-testid": "light-ball",
    "aria-label": "Direction of the key light; arrow keys turn it",
    title: "Drag to turn the key light; the ring is behind the model",
    "aria-valuemin": -180,
    "aria-valuemax": 180,
  });
  const current = () => {
    const values = (access.get() ?? "").split(",").map(Number);
    return values.length === 2 && values.every(Number.isFinite) ? values : [-50, 43];
  };
  const set = ([azimuth, elevation], moving) => access.set(`${Math.round(azimuth)},${Math.round(elevation)}`, moving);
  const follow = (event, moving) => {
    const box = canvas.getBoundingClientRect();
    const x = (2 * (event.clientX - box.left)) / box.width - 1,
      y = 1 - (2 * (event.clientY - box.top)) / box.height;
    set(light_at(x, y), moving);
  };
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    follow(event, true);
  });
  canvas.addEventListener("pointermove", (event) => canvas.hasPointerCapture(event.pointerId) && follow(event, true));
  canvas.addEventListener("keydown", (event) => {
    const step = { ArrowLeft: [-5, 0], ArrowRight: [5, 0], ArrowUp: [0, 5], ArrowDown: [0, -5] }[event.key];
    if (!step || event.ctrlKey || event.altKey) return;
    event.preventDefault();
    event.stopPropagation();
    const [azimuth, elevation] = current();
    set([((azimuth + step[0] + 540) % 360) - 180, clamp(elevation + step[1], -90, 90)], true);
  });
  let drawn = "";
  const refresh = () => {
    const [azimuth, elevation] = current(),
      is_set = access.get() !== undefined;
    const key = `${azimuth},${elevation},${is_set},${getComputedStyle(canvas).getPropertyValue("--is-dark")}`;
    if (key === drawn) return;
    drawn = key;
    canvas.setAttribute("aria-valuenow", azimuth);
    canvas.setAttribute("aria-valuetext", `azimuth ${azimuth}°, elevation ${elevation}°`);
    draw_ball(canvas, light_direction(azimuth, elevation), is_set);
  };
  return { root: canvas, refresh };
}
