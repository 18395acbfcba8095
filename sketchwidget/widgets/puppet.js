/* Expressions added up on the page: S* = S_0 + B beta, and eyeballs that turn as a whole.
 *
 * Model   geometry: "IPY_MODEL_<id>" of the pythreejs geometry that is moved; weights: {name: weight}; names: [title, [names]]
 *         of each group of sliders; performances: {name: {times, weights: {name: [...]}}}; playing: name of one, or "".
 * Sends   {type: "ready"} when the page can take a rig.
 * Takes   {type: "rig", vertices, step, counts: {name: n}, eyes: [{side, gaze: [up, down, in, out], count, centre, turns: [up,
 *         down, aside] degrees}]} with one buffer, gzipped: Float32 (V, 3) at rest, millimetres; then for each name of
 *         `counts` Uint16 (n) gaps between its vertices and Int16 (3, n) `step`s; then for each eye Uint16 (count) vertices;
 *         {type: "release"}: the head is moved no more.
 * Events  on the geometry, "sketchwidget:posed" after its positions are written, once a frame of the screen at most; after
 *         "sketchwidget:placed" there, they are written again.
 *
 * Sliders and performances work without the kernel; it is told of the sliders' weights when the hand lets go.
 */

const radians = (degrees) => (degrees * Math.PI) / 180;
const spoken = (name) => name.replace(/([A-Z])/g, " $1").toLowerCase();

async function unpacked(message, buffer) {
  const stream = new Blob([buffer]).stream().pipeThrough(new DecompressionStream("gzip"));
  const bytes = await new Response(stream).arrayBuffer();
  let at = 0;
  const take = (Type, count) => {
    const taken = new Type(bytes, at, count);
    at += Type.BYTES_PER_ELEMENT * count;
    return taken;
  };
  const rest = take(Float32Array, 3 * message.vertices);
  const moves = {};
  for (const [name, count] of Object.entries(message.counts)) {
    const vertices = take(Uint16Array, count);
    for (let i = 1; i < count; i++) vertices[i] += vertices[i - 1];
    moves[name] = { vertices, steps: take(Int16Array, 3 * count), step: message.step };
  }
  const eyes = message.eyes.map((eye) => ({ ...eye, vertices: take(Uint16Array, eye.count) }));
  return { rest, moves, eyes };
}

function add(positions, { vertices, steps, step }, weight) {
  const count = vertices.length;
  const unit = weight * step;
  for (let i = 0; i < count; i++) {
    const at = 3 * vertices[i];
    positions[at] += unit * steps[i];
    positions[at + 1] += unit * steps[count + i];
    positions[at + 2] += unit * steps[2 * count + i];
  }
}

/** As `Eyeball.rotation` has it: about the axis to the side first, then about the one upwards. */
function turn(positions, rest, { side, gaze, vertices, centre, turns }, weights) {
  const [up, down, inwards, outwards] = gaze.map((name) => weights[name] ?? 0);
  const pitch = radians(turns[0] * up - turns[1] * down);
  const yaw = radians(turns[2] * (outwards - inwards)) * (side === "left" ? 1 : -1);
  if (!pitch && !yaw) return;
  const [sinP, cosP, sinY, cosY] = [Math.sin(pitch), Math.cos(pitch), Math.sin(yaw), Math.cos(yaw)];
  for (const vertex of vertices) {
    const at = 3 * vertex;
    const [x, y, z] = [0, 1, 2].map((axis) => rest[at + axis] - centre[axis]);
    const [raised, deep] = [cosP * y + sinP * z, cosP * z - sinP * y];
    positions[at] = centre[0] + cosY * x + sinY * deep;
    positions[at + 1] = centre[1] + raised;
    positions[at + 2] = centre[2] + cosY * deep - sinY * x;
  }
}

/** The weights of a performance at a time in seconds. */
function sampled({ times, weights }, time) {
  let after = times.findIndex((key) => key > time);
  if (after < 0) after = times.length - 1;
  const before = Math.max(0, after - 1);
  const span = times[after] - times[before];
  const share = span ? Math.min(1, (time - times[before]) / span) : 0;
  const entries = Object.entries(weights);
  return Object.fromEntries(entries.map(([name, keys]) => [name, keys[before] + share * (keys[after] - keys[before])]));
}

export default () => {
  const panels = new Set();
  let geometry = null;
  let rig = null;
  let rigs = 0;
  let weights = {};
  let frame = 0;
  let began = null; // of what is played

  function show(model) {
    if (rig) frame ||= requestAnimationFrame((now) => pose(model, now));
  }

  function pose(model, now) {
    frame = 0;
    if (!rig || !geometry) return;
    const track = model.get("performances")[model.get("playing")];
    if (track) {
      began ??= now;
      const time = (now - began) / 1000;
      weights = sampled(track, time);
      if (time < track.times.at(-1)) show(model);
      else play(model, "");
    }
    const positions = geometry.getAttribute("position").array;
    positions.set(rig.rest);
    for (const [name, weight] of Object.entries(weights)) if (weight && rig.moves[name]) add(positions, rig.moves[name], weight);
    for (const eye of rig.eyes) turn(positions, rig.rest, eye, weights);
    geometry.dispatchEvent({ type: "sketchwidget:posed" });
    for (const panel of panels) panel.follow();
  }

  function play(model, name) {
    began = null;
    if (model.get("playing") !== name) {
      model.set("playing", name);
      model.save_changes();
    }
    show(model);
  }

  function initialize({ model }) {
    const again = () => show(model);
    weights = { ...model.get("weights") };
    model.on("msg:custom", async (message, buffers) => {
      const number = ++rigs;
      rig = null;
      if (message.type !== "rig") return;
      const unpacking = await unpacked(message, buffers[0]);
      const name = model.get("geometry").slice("IPY_MODEL_".length);
      const geometryModel = await model.widget_manager.get_model(name);
      await geometryModel.initPromise;
      if (number !== rigs) return;
      geometry = geometryModel.obj;
      geometry.addEventListener("sketchwidget:placed", again); // once, however often it is added
      rig = unpacking;
      show(model);
    });
    model.on("change:weights", () => {
      weights = { ...model.get("weights") };
      show(model);
    });
    model.on("change:playing", () => {
      began = null;
      show(model);
    });
    model.send({ type: "ready" });
  }

  function render({ model, el }) {
    el.classList.add("sketchwidget-puppet");
    const sliders = new Map();

    function set(name, value) {
      play(model, "");
      weights = { ...weights, [name]: value };
      show(model);
    }

    function tell() {
      const active = Object.entries(weights).filter(([, weight]) => weight);
      model.set("weights", Object.fromEntries(active));
      model.save_changes();
    }

    function button(text, title, act) {
      const made = Object.assign(document.createElement("button"), { textContent: text, title, type: "button" });
      made.addEventListener("click", act);
      return made;
    }

    function build() {
      sliders.clear();
      el.replaceChildren();
      const groups = model.get("names");
      if (!groups.length) return;
      const bar = document.createElement("div");
      bar.className = "sketchwidget-performances";
      for (const name of Object.keys(model.get("performances"))) {
        const made = button(`▶ ${name}`, `Play: ${name}`, () => play(model, model.get("playing") === name ? "" : name));
        made.dataset.performance = name;
        bar.append(made);
      }
      const rest = () => {
        play(model, "");
        weights = {};
        show(model);
        tell();
      };
      bar.append(button("rest", "All expressions at rest", rest));
      el.append(bar, ...groups.map(group));
    }

    function group([title, names]) {
      const made = document.createElement("details");
      const head = Object.assign(document.createElement("summary"), { textContent: `${title} (${names.length})` });
      made.append(head);
      for (const name of names) {
        const label = document.createElement("label");
        const slider = Object.assign(document.createElement("input"), { type: "range", min: 0, max: 1, step: 0.01, value: 0 });
        slider.dataset.expression = name;
        slider.addEventListener("input", () => set(name, Number(slider.value)));
        slider.addEventListener("change", tell);
        label.append(Object.assign(document.createElement("span"), { textContent: spoken(name), title: name }), slider);
        sliders.set(name, slider);
        made.append(label);
      }
      return made;
    }

    function follow() {
      for (const [name, slider] of sliders) slider.value = weights[name] ?? 0;
      for (const made of el.querySelectorAll("[data-performance]")) {
        made.classList.toggle("mod-active", made.dataset.performance === model.get("playing"));
      }
    }

    const panel = { follow };
    panels.add(panel);
    model.on("change:names change:performances", build);
    build();
    follow();
    return () => {
      panels.delete(panel);
      model.off("change:names change:performances", build);
    };
  }

  return { initialize, render };
};
