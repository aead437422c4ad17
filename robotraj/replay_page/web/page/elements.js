"use strict";
// Small helpers that every page needs: elements, buttons, packed data, a message of failure.

const byId = (id) => document.getElementById(id);

// An element with a text and a class.
function element(kind, text, style) {
  const made = document.createElement(kind);
  if (text !== undefined) made.textContent = text;
  if (style) made.className = style;
  return made;
}

// A button; pressed is left undefined where it is not a switch.
function button(text, title, pressed, act) {
  const made = Object.assign(element("button", text), { type: "button", title });
  if (pressed !== undefined) made.setAttribute("aria-pressed", String(pressed));
  made.addEventListener("click", act);
  return made;
}

// The bytes of an element with gzip in base64.
async function unpack(id) {
  const text = byId(id).textContent.trim();
  const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

function showFailure(text) {
  byId("failure").textContent = text;
  byId("failure").hidden = false;
}
