const FRAME = 1 / 30;  // time between keyframes [s]
const NIGHT = { top_color: [0.09, 0.1, 0.11], bottom_color: [0.16, 0.175, 0.19] };
const AT_NIGHT = { "#c8ced6": "#3a4047", "#b9bfc8": "#4d545d", "@MEASURED@": "#e6e6e6", "@WEIGHT@": "#b39a80" };  // ground, its lines, data, weights
const PAPER = [1600, 800];  // size of the printed picture: a window has no definite size while it is printed

const element = id => document.getElementById(id);
const round = (value, digits) => Number(value).toFixed(digits).replace(/^-(0(\.0+)?)$/, "$1").replace("-", "−");

async function unpack(id) {
  const packed = Uint8Array.from(atob(element(id).textContent), letter => letter.charCodeAt(0));
  return new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"))).text();
}

function make(tag, parent, text = "", className = "") {
  const made = document.createElement(tag);
  made.textContent = text;
  if (className) made.className = className;
  parent.append(made);
  return made;
}

// Object of the scene at a path such as "/exoid/left leg".
function finder(viewer) {
  return path => viewer.scene_tree.find(path.split("/").filter(name => name.length > 0));
}

// Fit everything into what panels leave of the window, until the user turns the view.
function fitCamera(viewer, view) {
  let turned = false;
  viewer.controls.addEventListener("start", () => { turned = true; });
  function frame(printed = false) {
    if (turned) return;
    const [width, height] = printed ? PAPER : [window.innerWidth, Math.max(window.innerHeight, 1)], narrow = width <= 620;
    const below = printed ? 0 : element("player").offsetHeight + (narrow ? element("plot").offsetHeight : 0);
    const covered = below > 0 ? Math.min((below + 16) / height, 0.6) : 0;
    const slope = Math.tan(viewer.camera.fov * Math.PI / 360);
    const needed = Math.max(view.half_height / (slope * (1 - covered)), view.half_width * height / (slope * width));
    const distance = 1.08 * needed + view.half_depth;
    const [x, y, z] = view.centre;
    const target = [x, y, z - covered * distance * slope];
    const [eye_x, eye_y, eye_z] = target.map((centre, i) => centre + distance * view.direction[i]);
    viewer.controls.target.set(target[0], target[2], -target[1]);  // meshcat's y axis points up
    viewer.camera.position.set(eye_x, eye_z, -eye_y);
    viewer.set_dirty();
  }
  window.addEventListener("resize", () => frame());
  return frame;
}

function checkbox(parent, text, id = "") {
  const label = make("label", parent), box = make("input", label);
  label.append(text);
  return Object.assign(box, { type: "checkbox", id });
}

function fillLegend(viewer, scene) {
  const node = finder(viewer), layers = element("layers");
  for (const layer of scene.layers) {
    const box = checkbox(layers, layer.label), swatches = make("span", box.parentElement, "", "swatches");
    box.checked = true;
    box.after(swatches);
    for (const colour of layer.colours) make("i", swatches).dataset.colour = colour;
    const show = () => {
      for (const path of layer.paths) node(path).set_property("visible", box.checked);
      viewer.set_dirty();
    };
    box.addEventListener("change", show);
    show();
    if (layer.scale) make("small", layers, layer.scale);
  }
  for (const note of scene.notes) make("p", layers, note);
}

// Colour before a dark background, where black parts of the leg would vanish: they become grey.
function lightened(colour) {
  const parts = colour.match(/[0-9a-f]{2}/gi).map(part => parseInt(part, 16));
  const more = Math.max(0, 104 - Math.max(...parts));
  return AT_NIGHT[colour.toLowerCase()] ?? "#" + parts.map(part => (part + more).toString(16).padStart(2, "0")).join("");
}

// Background, ground, dark arrows and black parts follow the colour scheme of the browser; paper is always light.
function followScheme(viewer, scene) {
  const node = finder(viewer), day = {};
  for (const command of scene.commands)
    if (command.path === "/Background" && command.type === "set_property") day[command.property] = command.value;
  function paint(night) {
    for (const [name, colour] of Object.entries(night ? NIGHT : day)) node("/Background").set_property(name, colour);
    viewer.show_background();
    const seen = colour => night ? lightened(colour) : colour;
    node("/exoid").object.traverse(part => {
      const surface = part.material;
      if (!surface || !surface.color) return;
      surface.userData.day ??= "#" + surface.color.getHexString();
      surface.color.set(seen(surface.userData.day));
    });
    for (const swatch of document.querySelectorAll("#layers i")) swatch.style.background = seen(swatch.dataset.colour);
    viewer.set_dirty();
  }
  const dark = window.matchMedia("(prefers-color-scheme: dark)");
  paint(dark.matches);
  dark.addEventListener("change", () => paint(dark.matches));
  return () => {
    paint(false);
    drawStill(viewer);
    paint(dark.matches);
  };
}

// A WebGL picture is empty on paper: copy it. A browser does not draw a page outside of its window before.
function drawStill(viewer) {
  viewer.set_3d_pane_size(...PAPER);
  viewer.controls.update();
  const size = viewer.renderer.domElement, still = element("still");
  viewer.renderer.render(viewer.scene, viewer.camera);
  still.width = size.width;
  still.height = size.height;
  still.getContext("2d").drawImage(size, 0, 0);
}

function play(viewer, scene) {
  const player = element("player");
  const [button, slider, clock, speed] = player.children;
  const animator = viewer.animator;
  player.hidden = false;
  slider.max = scene.duration;
  const seek = time => {
    const inside = Math.min(Math.max(time, 0), scene.duration);
    animator.seek(inside);
    animator.display_progress(inside);
  };
  const pause = () => { if (animator.playing) animator.pause(); };
  const turn = () => animator.playing ? animator.pause() : animator.play();
  const step = time => { pause(); seek(animator.time + time); };
  button.addEventListener("click", turn);
  slider.addEventListener("input", () => { pause(); seek(Number(slider.value)); });
  speed.addEventListener("change", () => { animator.mixer.timeScale = Number(speed.value); });
  const keys = {
    " ": turn,
    ArrowLeft: event => step(event.shiftKey ? -1 : -FRAME),
    ArrowRight: event => step(event.shiftKey ? 1 : FRAME),
    Home: () => step(-Infinity),
    End: () => step(Infinity),
  };
  document.addEventListener("keydown", event => {
    const own = event.target.closest("select, summary, button, [type=checkbox], .dg");
    const act = keys[event.key];
    if (!act || event.ctrlKey || event.altKey || event.metaKey || own && (event.key === " " || own.matches("select, .dg"))) return;
    event.preventDefault();
    act(event);
  }, true);
  const start = /[#&]t=([0-9.]+)/.exec(location.hash);
  if (start) { pause(); seek(Number(start[1])); }
  else if (window.matchMedia("(prefers-reduced-motion: reduce)").matches) pause();
  return {
    seek: time => { pause(); seek(time); },
    update: () => {
      button.textContent = animator.playing ? "Pause" : "Play";
      if (document.activeElement !== slider || animator.playing || Number(slider.value) !== animator.time) slider.value = animator.time;
      clock.textContent = animator.time.toFixed(2) + " s of " + scene.duration.toFixed(2) + " s";
    },
  };
}

(async function () {
  const script = document.createElement("script");
  script.textContent = await unpack("viewer");
  document.head.append(script);
  const scene = JSON.parse(await unpack("scene"));
  const viewer = new MeshCat.Viewer(element("meshcat-pane"));
  scene.commands.forEach(command => viewer.handle_command(command));

  const shadow = finder(viewer)("/Lights/SpotLight/<object>").object.shadow;
  shadow.normalBias = 0.02;
  shadow.radius = 4;

  const legend = element("legend");
  legend.querySelector("summary").textContent = scene.title;
  legend.open = window.innerWidth > 620;
  fillLegend(viewer, scene);
  const drawForPaper = followScheme(viewer, scene);

  const player = scene.duration > 0 ? play(viewer, scene) : null;
  const frame = fitCamera(viewer, scene.camera);
  const updates = [showNames(viewer, scene)];
  if (player) updates.push(player.update);
  if (player && scene.joints.some(joint => joint.measured)) updates.push(showPlot(scene, player.seek, frame));
  checkbox(element("tools"), "Viewer controls", "show-viewer");
  frame();
  window.addEventListener("beforeprint", () => { frame(true); drawForPaper(); });
  window.addEventListener("afterprint", () => { viewer.set_3d_pane_size(); frame(); });
  (function update() {
    for (const each of updates) each(viewer.animator.time);
    requestAnimationFrame(update);
  })();

  window.exoid = { viewer, scene };
})().catch(error => {
  const legend = element("legend");
  legend.querySelector("summary").textContent = "This browser cannot show the scene";
  legend.append(String(error));
  console.error(error);
});
