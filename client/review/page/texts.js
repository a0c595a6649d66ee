// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors

const given = document.getElementById("texts")?.textContent ?? "";
const texts = given.startsWith("{") ? JSON.parse(given) : {};

/// A text in the report's language; `{0}`, `{1}`, ... stand for the values.
export function t(english, ...values) {
  return (texts[english] ?? english).replace(/\{(\d)\}/g, (_, i) => String(values[Number(i)]));
}
