// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
import { aimOf, element, light, moment, number, sessionName } from "./element.js";
import { t } from "./texts.js";

function outcomeWord(record) {
  return record.success === null ? t("Outcome unknown") : record.success ? t("Intubated") : t("Not intubated");
}

function outcomeLight(record) {
  const word = record.success === null ? "near" : record.success ? "reached" : "missed";
  const sign = light(word);
  sign.lastChild.remove();  // the heading has the word
  return sign;
}

function how(session) {
  return session.live ? t(", still being recorded") : session.finished ? "" : t(", cut off before its end");
}

/// Whether the last attempt already says what became of the run. The run is judged at the session's end, when the
/// tube may lie a millimetre elsewhere: a second depth for the same attempt would only raise questions.
function lastAttemptSaysIt(session) {
  const last = session.attempts.at(-1);
  return last !== undefined && session.run.success !== null && last.success === session.run.success;
}

/// What became of each session and of its attempts.
export function outcomes({ sessions }) {
  const columns = element("div", { class: "columns" });
  sessions.forEach((session, index) => {
    const column = element("div", {},
      element("h1", {}, sessionName(session, index, sessions.length)),
      element("p", { class: "outcome" }, outcomeLight(session.run), " ", outcomeWord(session.run)),
      lastAttemptSaysIt(session) ? null : element("p", { class: "reason" }, session.run.reason),
      element("p", { class: "soft" },
        t("{0}; session {1}, {2}, {3} s{4}; recorded by version {5}", session.file, session.session,
          session.start_time, session.duration_s.toFixed(1), how(session), session.version)));
    if (session.lost_records > 0) {
      column.append(element("p", {}, t("{0} records were lost, because the disk was too slow.",
        session.lost_records)));
    }
    for (const attempt of session.attempts) {
      column.append(element("p", { class: "attempt" }, outcomeLight(attempt),
        " ", t("Attempt {0}: {1}; {2}", attempt.attempt, outcomeWord(attempt).toLowerCase(), attempt.reason)));
    }
    if (session.debriefing) {
      column.append(element("p", {}, t("To discuss: {0}", session.debriefing)));
    }
    columns.append(column);
  });
  return element("section", { id: "outcome" }, columns);
}

/// Of the first session: what to practise, farthest from its aim first.
export function practice({ sessions, fields }, seek) {
  const [session] = sessions;
  const section = element("section", { id: "practise" }, element("h2", {}, t("To practise")));
  const list = element("ol", { class: "practise" });
  for (const item of session.practise) {
    const field = fields.find((one) => one.key === item.key);
    list.append(element("li", {},
      element("strong", {}, item.practise), ". ",
      light(item.light), " ",
      `${field.label}: ${number(item.value)}${field.unit ? ` ${field.unit}` : ""}`, t(", at "), moment(item.time_s, 0, seek),
      element("div", { class: "soft" }, t("Aim: {0}. Measured: {1}.", aimOf(field, fields), field.definition))));
  }
  section.append(session.practise.length > 0
    ? list : element("p", {}, t("All measured aims are reached.")));
  return section;
}

const worthListing = 0.05;  // log odds, of a contribution

/// What the automatic score makes of each session, and from what.
export function scores({ sessions }) {
  const columns = element("div", { class: "columns" });
  sessions.forEach((session, index) => {
    const { score } = session;
    const column = element("div", {}, sessions.length > 1 ? element("h3", {}, sessionName(session, index, sessions.length)) : null);
    columns.append(column);
    if (!score) {
      column.append(element("p", {}, t("Not scored, as the outcome is unknown.")));
      return;
    }
    const shown = score.contributions.filter((one) => Math.abs(one.log_odds) >= worthListing);
    const small = score.contributions.length - shown.length;
    column.append(
      element("p", { class: "outcome", "data-grade": score.grade }, t("{0} of {1}", score.grade.toFixed(1), score.of)),
      element("p", {}, outcomeLight(session.run), " ", outcomeWord(session.run)),
      element("p", { class: "soft" }, score.statement),
      element("table", {}, element("tbody", {}, ...shown.map((one) => element("tr", { "data-contribution": one.key },
        element("td", {}, one.label + (one.measured ? "" : t(": not reached, counted as the worst value"))),
        element("td", { class: "number" }, `${one.log_odds < 0 ? "−" : "+"}${Math.abs(one.log_odds).toFixed(2)}`))))),
      element("p", { class: "soft" }, small > 0 ? t("{0} more contribute less than {1} each.", small, worthListing) : ""));
  });
  return element("section", { id: "score" }, element("h2", {}, t("Automatic score")),
    element("p", { class: "soft" }, t("Contributions of each metric and the outcome, in log odds of a better grade. A positive value means better than the average of the training sessions. They add up to the score.")),
    columns);
}

/// A metric's name, which shows its definition when tapped, clicked or chosen with the keyboard.
function definition(field) {
  return element("details", { class: "definition" }, element("summary", {}, field.label),
    element("div", { class: "soft" }, field.definition));
}

/// A column for each run, or for run and attempts of a single session.
export function parameterTable({ sessions, fields }) {
  const [first] = sessions;
  const alone = sessions.length === 1;
  const columns = alone && first.attempts.length > 0
    ? [[t("Run"), first.run], ...first.attempts.map((one) => [t("Attempt {0}", one.attempt), one])]
    : sessions.map((session, index) => [sessionName(session, index, sessions.length), session.run]);
  const head = element("tr", {}, element("th", {}, t("Metric")), element("th", {}, t("Unit")),
    ...columns.map(([name]) => element("th", { class: "number" }, name)), element("th", {}, t("Aim and its source")));
  const body = element("tbody");
  for (const inPaper of [true, false]) {
    body.append(element("tr", { class: "part" }, element("th", { colspan: columns.length + 3 },
      inPaper ? t("Metrics of Xiao et al. 2020") : t("Beyond the paper"))));
    fields.forEach((field, row) => {
      if (field.in_paper !== inPaper) {
        return;
      }
      const cells = columns.map(([, record], column) => {
        const value = record.values[row];
        const cell = element("td", { class: "number", "data-key": field.key, "data-column": column,
          "data-value": value === null ? "null" : value }, number(value), " ", light(record.lights[row]));
        if (!alone && column > 0 && value !== null && first.run.values[row] !== null) {
          const difference = value - first.run.values[row];
          cell.append(element("span", { class: "difference" },
            t("{0} to the first", `${difference < 0 ? "−" : "+"}${number(Math.abs(difference))}`)));
        }
        return cell;
      });
      body.append(element("tr", {}, element("td", {}, definition(field)),
        element("td", {}, field.unit), ...cells,
        element("td", { class: "aim soft" }, aimOf(field, fields))));
    });
  }
  return element("section", { id: "parameters" }, element("h2", {}, t("Metrics")),
    element("p", { class: "soft" }, t("A light shows whether a value reaches its aim, is near it or misses it. Metrics without a known aim have none. "), element("span", { class: "screen" }, t("Tap a name to see its definition."))),
    element("div", { class: "wide" }, element("table", {}, element("thead", {}, head), body)));
}

/// A section of one table per session; `rows` gives a session's rows as lists of cells.
function tables(id, title, sessions, rows) {
  return element("section", { id }, element("h2", {}, title),
    element("div", { class: "columns" }, ...sessions.map((session, index) => element("div", {},
      sessions.length > 1 ? element("h3", {}, sessionName(session, index, sessions.length)) : null,
      element("div", { class: "events" }, element("table", {}, element("tbody", {},
        ...rows(session, index).map((row) => element("tr", {}, ...row.map((cell) => element("td", {}, cell)))))))))));
}

export function eventList(sessions, seek) {
  return tables("events", t("Events"), sessions, (session, index) => session.events.map(
    (event) => [moment(event.time_s, index, seek), t(event.kind), event.text]));
}

/// What instructors and participants said after the sessions.
export function opinions(sessions) {
  return tables("opinions", t("Ratings and answers"), sessions, (session) => [
    ...session.ratings.map((one) => [one.item, t("{0} of {1}", one.score, 5), t("rated by {0}", one.rater)]),
    ...session.answers.map((one) => [one.text, one.answer, one.form])]);
}
