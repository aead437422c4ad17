"use strict";
// The proof: figures with their goals, and the violated rows, which seek to their times.

function scientific(value) {
  if (value === null) return "–";
  const small = value !== 0 && Math.abs(value) < 1e-2;
  return minus(small ? value.toExponential(1) : String(Number(value.toPrecision(5))));
}

class ProofPanel {
  constructor(host, seek) {
    Object.assign(this, { host, seek });
  }

  fill({ figures, violations, conflicts, message, report }, status) {
    this.host.replaceChildren(element("h2", "Proof"), this.verdict(status), this.figures(figures));
    this.host.append(element("h2", "Violated rows"));
    if (!violations.length) this.host.append(element("p", "None."));
    else this.host.append(this.violations(violations));
    for (const conflict of conflicts) this.host.append(element("p", `In conflict: ${conflict}`, "bad"));
    if (message) this.host.append(element("p", `Solver: ${message}`));
    if (report) this.host.append(element("h2", "Validation"), Object.assign(element("pre", report), { tabIndex: 0 }));
  }

  verdict({ text, colour }) {
    const line = element("p");
    line.append(element("span", text, `status ${colour}`));
    return line;
  }

  figures(figures) {
    const table = element("table", undefined, "figures");
    const head = table.createTHead().insertRow();
    for (const name of ["measure", "value", "goal"]) head.append(Object.assign(element("th", name), { scope: "col" }));
    const body = table.createTBody();
    for (const figure of figures) {
      const row = body.insertRow();
      row.append(Object.assign(element("th", figure.name), { scope: "row" }));
      const value = row.insertCell();
      value.append(element("span", scientific(figure.value), `figure ${figure.colour}`));
      row.insertCell().textContent = figure.goal ? `≤ ${scientific(figure.goal)}` : "";
    }
    return table;
  }

  violations(violations) {
    const list = element("ol");
    for (const violation of violations) {
      const item = element("li");
      item.append(button(violation.text, "Go to this time", undefined, () => violation.t !== null && this.seek(violation.t)));
      list.append(item);
    }
    return list;
  }
}
