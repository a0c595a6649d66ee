// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors

import { t } from "./texts.js";

/// An element with attributes (`on...`: a listener) and children. Texts never become markup.
export function element(name, attributes = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key.startsWith("on")) {
      made.addEventListener(key.slice(2), value);
    } else if (value !== null && value !== undefined) {
      made.setAttribute(key, value);
    }
  }
  made.append(...children.filter((child) => child !== null && child !== undefined));
  return made;
}

const drawings = {
  reached: ["#00705c", "M6.5 0.5a6 6 0 1 1 0 12a6 6 0 1 1 0-12z"],
  near: ["#c98500", "M6.5 0.8L12.7 12.2H0.3z"],
  missed: ["#b3261e", "M1 1h11v11h-11z"],
};

/// A light as shape and word; nothing where nothing is aimed at.
export function light(word) {
  if (!drawings[word]) {
    return null;
  }
  const [colour, path] = drawings[word];
  const space = "http://www.w3.org/2000/svg";
  const drawing = document.createElementNS(space, "svg");
  drawing.setAttribute("viewBox", "0 0 13 13");
  drawing.setAttribute("aria-hidden", "true");
  const shape = document.createElementNS(space, "path");
  shape.setAttribute("d", path);
  shape.setAttribute("fill", colour);
  drawing.append(shape);
  return element("span", { class: "light", "data-light": word }, drawing, t(word));
}

/// Counts and grades without decimals, as the printed summary has them; a dash for what does not exist.
export function number(value) {
  if (value === null) {
    return "–";
  }
  return Number.isInteger(value) && Math.abs(value) < 1e6 ? value.toFixed(0) : value.toFixed(2);
}

/// A field's aim in words; where it names another parameter, with what that one is.
export function aimOf(field, fields) {
  return field.norm.replace(/`([^`]*)`/g, (_, key) => {
    const other = fields.find((one) => one.key === key);
    return other ? `${other.label}: ${other.definition}` : key;
  });
}

/// A button that goes to a moment.
export function moment(time, session, seek) {
  return element("button", { class: "moment", title: t("Show this moment"), onclick: () => seek(time, session) },
    `${time.toFixed(1)} s`);
}

/// What a session is called on the page; several of one name are told apart by their number.
export function sessionName(session, index, count) {
  const who = [session.scenario, session.operator].filter(Boolean).join(", ") || session.session || session.file;
  return count > 1 ? `${index + 1}: ${who}` : who;
}
