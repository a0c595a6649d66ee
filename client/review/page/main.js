// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
import "uplot/dist/uPlot.min.css";
import "./style.css";
import { eventList, opinions, outcomes, parameterTable, practice, scores } from "./summary.js";
import { element } from "./element.js";
import { t } from "./texts.js";
import { Timeline } from "./timeline.js";
import { anatomySection } from "./anatomy.js";

const data = JSON.parse(document.getElementById("sessions").textContent);
const page = document.getElementById("page");
page.replaceChildren();

// What shows a moment, and is told when another is chosen: seek(time in s, index of the session).
const followers = [];
const seek = (time, session) => followers.forEach((follow) => follow(time, session));

page.append(outcomes(data), practice(data, seek));
const timeline = new Timeline(data.sessions, seek);
page.append(timeline.section);
followers.push((time, session) => timeline.mark(time, session));
const anatomy = anatomySection(data.sessions, seek);
page.append(anatomy.section);
followers.push(anatomy.seek);
if (data.sessions.some((session) => "score" in session)) {
  page.append(scores(data));
}
page.append(parameterTable(data), eventList(data.sessions, seek));
if (data.sessions.some((session) => session.ratings.length + session.answers.length > 0)) {
  page.append(opinions(data.sessions));
}
page.append(element("p", { class: "soft" },
  t("NeoETI {0}. Not a medical device; does not certify skill. This page makes no network connections.",
    data.program)));
timeline.draw();
anatomy.draw();
document.documentElement.dataset.ready = "yes";
