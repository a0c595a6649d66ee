// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
import uPlot from "uplot";
import { element, sessionName } from "./element.js";
import { t } from "./texts.js";

// Okabe and Ito's colours for any eye that stand out from white, each with its own dash.
const strokes = ["#0b5cad", "#d55e00", "#007a5a", "#a0457c"];
const dashes = [[], [8, 4], [2, 3], [10, 3, 2, 3]];
const height = 150;

/// A chart for each measure, with a line for each session. Zoom by dragging, back by a double click; lines are
/// switched in the legend.
export class Timeline {
  constructor(sessions, seek) {
    this.sessions = sessions;
    this.seek = seek;
    this.now = null;
    this.charts = [];
    this.place = element("div", { class: "charts" });
    this.section = element("section", { id: "timeline" }, element("h2", {}, t("Timeline")),
      element("p", { class: "soft screen" },
        t("Drag to zoom in, double-click to zoom out; click to show a moment in 3-D. "),
        t("Thin lines are events of the first session.")),
      this.place);
  }

  /// Once the section is in the page, which has a width then.
  draw() {
    const width = () => Math.max(260, this.place.clientWidth);
    const common = uPlot.sync("time");
    this.sessions[0].samples.lines.forEach((line, row) => {
      const has = (session) => session.samples.lines[row].values.some((value) => value !== null);
      if (!this.sessions.some(has)) {
        return;
      }
      const joined = uPlot.join(this.sessions.map((session) =>
        [session.samples.time_s, session.samples.lines[row].values]));
      const options = {
        title: `${line.label} [${line.unit}]`,
        width: width(),
        height,
        cursor: { sync: { key: common.key, setSeries: true }, points: { size: 6 } },
        // From 0 s on, unless zoomed: the first sample lies after it, and its time is no round number.
        scales: { x: { time: false, range: (chart, low, high) => [low === chart.data[0][0] ? 0 : low, high] } },
        axes: [{ size: 28, values: (_, all) => all.map((value) => `${value} s`) }, { size: 46 }],
        series: [{ label: t("Time"), value: (_, value) => (value === null ? "–" : `${value.toFixed(2)} s`) },
          ...this.sessions.map((session, index) => ({
            label: sessionName(session, index, this.sessions.length),
            stroke: strokes[index],
            dash: dashes[index],
            width: 1.6,
            // Times of other sessions leave holes in this one's line; real gaps are nulls of its own.
            spanGaps: this.sessions.length > 1,
            points: { show: false },
            value: (_, value) => (value === null || value === undefined ? "–" : value.toFixed(2)),
          }))],
        hooks: { draw: [(chart) => this.drawMarks(chart)] },
      };
      const chart = new uPlot(options, joined, this.place);
      // A click, not the end of a drag.
      let pressed = null;
      chart.over.addEventListener("mousedown", (event) => { pressed = event.clientX; });
      chart.over.addEventListener("click", (event) => {
        if (pressed !== null && Math.abs(event.clientX - pressed) < 3) {
          this.seek(chart.posToVal(event.offsetX, "x"), 0);
        }
      });
      this.charts.push(chart);
    });
    addEventListener("resize", () => this.charts.forEach((chart) => chart.setSize({ width: width(), height })));
    // Paper is narrower than a screen.
    addEventListener("beforeprint", () => this.charts.forEach((chart) => chart.setSize({ width: 680, height: 120 })));
    addEventListener("afterprint", () => this.charts.forEach((chart) => chart.setSize({ width: width(), height })));
  }

  /// The moment that is shown elsewhere.
  mark(time) {
    this.now = time;
    this.charts.forEach((chart) => chart.redraw(false));
  }

  drawMarks(chart) {
    const context = chart.ctx;
    const { left, top, width, height: tall } = chart.bbox;
    const stroke = (time, colour, thick) => {
      const x = Math.round(chart.valToPos(time, "x", true)) + 0.5;
      if (x >= left && x <= left + width) {
        context.strokeStyle = colour;
        context.lineWidth = thick;
        context.beginPath();
        context.moveTo(x, top);
        context.lineTo(x, top + tall);
        context.stroke();
      }
    };
    context.save();
    context.setLineDash([]);
    for (const event of this.sessions[0].events) {
      stroke(event.time_s, "#55606b80", 1);
    }
    if (this.now !== null) {
      stroke(this.now, "#000000", 2);
    }
    context.restore();
  }
}
