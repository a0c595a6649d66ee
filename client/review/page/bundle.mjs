// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors

// node bundle.mjs PACKAGES OUT: the page with its styles and scripts in it, and a place for sessions.
import { readFileSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";

const [packages, out] = process.argv.slice(2).map((path) => resolve(path));
const here = dirname(fileURLToPath(import.meta.url));
const esbuild = createRequire(join(packages, "package.json"))("esbuild");

const result = await esbuild.build({
  entryPoints: [join(here, "main.js")],
  bundle: true,
  minify: true,
  write: false,
  outdir: "out",
  format: "iife",
  target: "es2022",
  charset: "utf8",
  legalComments: "eof",
  nodePaths: [join(packages, "node_modules")],
});
const text = (end) => result.outputFiles.find((file) => file.path.endsWith(end)).text;
// As functions: `$` in a replacing text would mean something.
writeFileSync(out, readFileSync(join(here, "page.html"), "utf8")
  .replace("/*style*/", () => text(".css"))
  .replace("/*script*/", () => text(".js")));
