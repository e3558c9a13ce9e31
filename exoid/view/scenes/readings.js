// Value of a series of frames at a time, or null where there is none.
function at(series, time) {
  if (!series) return null;
  const place = Math.min(Math.max(time / FRAME, 0), series.length - 1);
  const before = Math.floor(place), after = Math.min(before + 1, series.length - 1);
  if (series[before] === null || series[after] === null) return null;
  return series[before] + (place - before) * (series[after] - series[before]);
}

// Names of the joints beside them, with angle and torque.
function showNames(viewer, scene) {
  const node = finder(viewer), names = element("names");
  const labels = scene.joints.map(joint => {
    const label = make("span", names);
    label.style.borderColor = joint.colour;
    return label;
  });
  const box = checkbox(element("tools"), "Names and numbers", "show-names");
  return time => {
    names.hidden = !box.checked;
    if (names.hidden) return;
    scene.joints.forEach((joint, i) => {
      const numbers = [[at(joint.angle, time), joint.unit], [at(joint.torque, time), joint.torque_unit]]
        .filter(([value]) => value !== null)
        .map(([value, unit]) => `${round(value, 1)} ${unit}`);
      labels[i].textContent = [joint.name, ...numbers].join("\n");
      const object = node(joint.path).object;
      const place = object.getWorldPosition(object.position.clone()).project(viewer.camera);
      const x = (place.x + 1) / 2 * window.innerWidth + 14, y = (1 - place.y) / 2 * window.innerHeight - labels[i].offsetHeight / 2;
      labels[i].style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px)`;
    });
  };
}

function draw(tag, parent, attributes) {
  const made = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  parent.append(made);
  return made;
}

// Curve of a series of frames, with gaps where there is no value.
function curve(series, height) {
  const place = (value, frame) => `${series[frame - 1] == null ? "M" : "L"}${(frame * FRAME).toFixed(3)} ${height(value).toFixed(2)}`;
  return series.map((value, frame) => value === null ? "" : place(value, frame)).join("");
}

// Measured and predicted torque over time, feet first, with a line at the time of the playback; a click goes to a time.
function showPlot(scene, seek, frame) {
  const plot = element("plot"), joints = scene.joints.filter(joint => joint.measured);
  const key = make("p", plot);
  make("b", key, "measured").style.borderColor = "var(--measured)";
  if (joints.some(joint => joint.predicted)) make("b", key, "predicted").style.borderColor = "var(--predicted)";
  const feet = joints.filter(joint => joint.foot).sort((a, b) => a.path < b.path ? -1 : 1), many = joints.length > 4;
  plot.classList.toggle("many", many);  // two columns: left and right
  const charts = [feet, joints.filter(joint => !joint.foot)].flatMap(group => {
    const box = make("div", plot);
    box.style.setProperty("--rows", Math.ceil(group.length / 2));
    return group.map(joint => [joint, box]);
  }).map(([joint, box]) => {
    const figure = make("figure", box), caption = make("figcaption", figure);
    make("span", caption, joint.name).style.borderColor = joint.colour;
    const number = make("span", caption);
    const values = [0, ...joint.torque, ...(joint.predicted ?? [])].filter(value => value !== null);
    const low = values.reduce((a, b) => Math.min(a, b)), high = Math.max(values.reduce((a, b) => Math.max(a, b)), low + 1e-9);
    const height = value => 62 - 60 * (value - low) / (high - low);
    const extent = `${round(low, 1)} to ${round(high, 1)} ${joint.torque_unit}`;
    const svg = draw("svg", figure, {
      viewBox: `0 0 ${scene.duration} 64`, preserveAspectRatio: "none", role: "img", "aria-label": `Torque of ${joint.name} over time, ${extent}`,
    });
    draw("line", svg, { class: "zero", x2: scene.duration, y1: height(0), y2: height(0) });
    draw("path", svg, { class: "measured", d: curve(joint.torque, height) });
    if (joint.predicted) draw("path", svg, { class: "predicted", d: curve(joint.predicted, height) });
    const now = draw("line", svg, { class: "now", y2: 64 });
    svg.addEventListener("click", event => {
      const box = svg.getBoundingClientRect();
      seek(scene.duration * (event.clientX - box.left) / box.width);
    });
    const range = make("small", figure);
    make("span", range, extent);
    make("span", range, `${scene.duration.toFixed(1)} s`);
    return { joint, number, now };
  });
  const box = checkbox(element("tools"), "Torque plot", "show-plot");
  box.addEventListener("change", () => { plot.hidden = !box.checked; frame(); });
  box.checked = window.innerWidth >= (many ? 1200 : 1000);
  plot.hidden = !box.checked;
  return time => {
    if (plot.hidden) return;
    for (const { joint, number, now } of charts) {
      now.setAttribute("x1", time);
      now.setAttribute("x2", time);
      const predicted = at(joint.predicted, time), measured = at(joint.torque, time);
      const both = [measured, predicted].filter(value => value !== null).map(value => round(value, 1));
      number.textContent = `${both.join(" / ")} ${joint.torque_unit}`;
    }
  };
}
