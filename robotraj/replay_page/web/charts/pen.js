"use strict";
// What every canvas needs: a pen with the resolution of the screen, and straight lines.

// Clear a canvas of this size [CSS pixels]; return its context, whose unit is one CSS pixel.
function penOf(canvas, width, height) {
  const ratio = window.devicePixelRatio || 1;
  [canvas.width, canvas.height] = [Math.round(width * ratio), Math.round(height * ratio)];
  const pen = canvas.getContext("2d");
  pen.scale(ratio, ratio);
  return pen;
}

function drawLine(pen, x0, y0, x1, y1, color) {
  if (color) pen.strokeStyle = color;
  pen.beginPath();
  pen.moveTo(x0, y0);
  pen.lineTo(x1, y1);
  pen.stroke();
}
