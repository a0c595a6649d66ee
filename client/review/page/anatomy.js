// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
import { element, sessionName } from "./element.js";
import { indexAt, Recording } from "./recording.js";
import { t } from "./texts.js";
import { Viewer } from "./viewer.js";

const picture = [640, 460];

/// The 3-D view with its slider, and pictures at key moments. Returns the section, seek(time, session) and draw(), which is
/// called once it is in the page.
export function anatomySection(sessions, seek) {
  const stage = element("div", { class: "stage screen" });
  const slider = element("input", { type: "range", min: 0, max: 1, step: "any", value: 0, "aria-label": t("Moment"),
    oninput: () => { stop(); seek(Number(slider.value), shown); } });
  const clock = element("output", {}, "0.0 s");
  const play = element("button", { onclick: () => (timer === null ? start() : stop()) }, t("Play"));
  const section = element("input", { type: "checkbox", checked: "", onchange: () => viewer?.cut(section.checked) });
  const views = element("select", { "aria-label": t("View from"), onchange: () => viewer?.look(views.value) },
    element("option", { value: "near" }, t("from the left, near")),
    element("option", { value: "beside" }, t("from the left")), element("option", { value: "above" }, t("from above the face")),
    element("option", { value: "eye" }, t("from the operator")));
  const choice = element("select", { "aria-label": t("Session"), onchange: () => open(Number(choice.value), 0) },
    ...sessions.map((session, index) => element("option", { value: index }, sessionName(session, index, sessions.length))));
  const gallery = element("div", { class: "gallery" });
  const whole = element("section", { id: "anatomy" }, element("h2", {}, t("Tools over the anatomy")),
    element("div", { class: "bar screen" }, play, slider, clock,
      element("label", {}, section, t(" section in the midline")), views, sessions.length > 1 ? choice : null),
    stage,
    element("p", { class: "soft" }, t("Blue: path of the blade's tip; brown: path of the tube's tip. "),
      element("span", { class: "screen" }, t("Drag to rotate; wheel or pinch to zoom."))),
    gallery);

  let viewer = null;
  let recording = null;
  let shown = 0;
  let timer = null;

  function stop() {
    cancelAnimationFrame(timer);
    timer = null;
    play.textContent = t("Play");
  }

  function start() {
    play.textContent = t("Pause");
    let before = performance.now();
    let time = Number(slider.value) >= recording?.end ? 0 : Number(slider.value);
    const step = (now) => {
      time += (now - before) / 1000;
      before = now;
      seek(Math.min(time, recording.end), shown);
      timer = time < recording.end ? requestAnimationFrame(step) : null;
      if (timer === null) {
        stop();
      }
    };
    if (recording) {
      timer = requestAnimationFrame(step);
    }
  }

  function present(time) {
    slider.value = time;
    clock.textContent = `${time.toFixed(1)} s`;
    stage.dataset.time = time;
    if (viewer) {
      const passed = recording.toolTimes.length > 0 ? indexAt(recording.toolTimes, time) + 1 : 0;
      viewer.show(recording.at(time), passed);
    }
  }

  async function open(index, time) {
    stop();
    shown = index;
    choice.value = index;
    const { anatomy } = sessions[index];
    recording = await Recording.of(anatomy);
    try {
      viewer?.renderer.dispose();
      viewer = new Viewer(anatomy, Math.max(260, stage.clientWidth), Math.max(240, stage.clientHeight));
    } catch {
      viewer = null;
      stage.textContent = t("This browser does not support WebGL, so there is no 3-D view. Numbers and charts are complete.");
      return;
    }
    const paths = [[], []];
    for (let i = 0; i < recording.toolTimes.length; ++i) {
      paths[0].push(...viewer.bladeTipAt(recording.laryngoscope.subarray(7 * i, 7 * i + 7)));
      paths[1].push(...recording.tube.subarray(recording.tubeSize * (i + 1) - 3, recording.tubeSize * (i + 1)));
    }
    viewer.showPaths(...paths.map((points) => new Float32Array(points)));
    stage.replaceChildren(viewer.renderer.domElement);
    slider.max = recording.end;
    takePictures(sessions[index]);
    viewer.cut(section.checked);
    viewer.look(views.value);
    present(time);
  }

  function takePictures({ moments }) {
    viewer.resize(...picture);
    viewer.cut(true);
    viewer.look("near");
    gallery.replaceChildren(...moments.map(({ label, time_s: time }) => {
      present(time);
      return element("figure", {},
        element("img", { src: viewer.picture(), alt: t("{0}, in the midline's section", label), width: picture[0],
          height: picture[1] }),
        element("figcaption", {}, t("{0}, at {1} s", label, time.toFixed(1))));
    }));
    viewer.resize(Math.max(260, stage.clientWidth), Math.max(240, stage.clientHeight));
  }

  addEventListener("resize", () => viewer?.resize(Math.max(260, stage.clientWidth), Math.max(240, stage.clientHeight)));
  return {
    section: whole,
    async draw() {
      await open(0, 0);
      seek(sessions[0].moments[0]?.time_s ?? 0, 0);
      whole.dataset.ready = "yes";
    },
    seek(time, session) {
      if (session !== shown) {
        open(session, time);
      } else {
        present(time);
      }
    },
  };
}
