"use strict";
// The settings of a plan: a row for each, with the choice and its reason, which wrap in a narrow window.

function settingsTable(text) {
  if (!text) return element("p", "None.");
  const table = element("table", undefined, "settings");
  const body = table.createTBody();
  for (const line of text.split("\n")) {
    const [, name, rest] = /^(\S*)\s+(.*)$/.exec(line) || [line, "", line];
    // A line that begins with blanks goes on with the setting above.
    if (name === "" && body.lastChild) body.lastChild.lastChild.append(` ${rest}`);
    else {
      const row = body.insertRow();
      row.append(Object.assign(element("th", name), { scope: "row" }), element("td", rest));
    }
  }
  return table;
}
