// Colours for all users: the phase map as the three kinds of colour blindness see it, in CIE L*a*b*.
import { expect, test } from "vitest";

import { entry } from "../src/painter/maps.ts";
import { lab, type Row } from "./lab.ts";

/** Matrices from linear RGB to the colours that people see: Machado, Oliveira and Fernandes 2009, severity 1. */
const SEEN: Record<string, [Row, Row, Row]> = {
  "normal sight": [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
  protanopia: [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
  deuteranopia: [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.01182, 0.04294, 0.968881]],
  tritanopia: [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.3039]],
};
test.each(Object.entries(SEEN))("phases a quarter of a turn apart differ by 40 or more: %s", (_, sight) => {
  const away = (s: number, t: number) => {
    const [a, b] = [s, t].map((at) => lab(entry("phase", at % 1), sight));
    return Math.hypot(...a.map((value, k) => value - b[k]));
  };
  const all = Array.from({ length: 96 }, (_, k) => k / 96);
  expect(Math.min(...all.map((t) => away(t, t + 0.25)))).toBeGreaterThan(40);
  // Phases half a turn apart differ by at least 40, too, so no two phases look alike.
  expect(Math.min(...all.map((t) => away(t, t + 0.5)))).toBeGreaterThan(40);
  // Steps of 15 degrees have similar differences of colour.
  const steps = all.map((t) => away(t, t + 1 / 24));
  expect(Math.max(...steps) / Math.min(...steps)).toBeLessThan(2.2);
});
