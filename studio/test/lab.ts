/** Colours in CIE L*a*b*, as people see them. */

export type Row = [number, number, number];

/** The matrix from linear sRGB to CIE XYZ under D65. */
const XYZ: [Row, Row, Row] = [[0.4124564, 0.3575761, 0.1804375], [0.2126729, 0.7151522, 0.072175], [0.0193339, 0.119192, 0.9503041]];

const times = (rows: Row[], by: number[]) => rows.map((row) => row.reduce((sum, value, k) => sum + value * by[k], 0));
const linear = (value: number) => (value <= 0.04045 ? value / 12.92 : ((value + 0.055) / 1.055) ** 2.4);
const WHITE = times(XYZ, [1, 1, 1]);

/** Returns CIE L*a*b* of red, green and blue, 0 to 255, as seen through `sight` (a matrix of linear RGB). */
export function lab(rgb: number[], sight: Row[] = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]): number[] {
  const seen = times(sight, rgb.map((value) => linear(value / 255))).map((value) => Math.min(Math.max(value, 0), 1));
  const [x, y, z] = times(XYZ, seen).map((value, k) => {
    const t = value / WHITE[k];
    return t > 216 / 24389 ? Math.cbrt(t) : ((24389 / 27) * t + 16) / 116;
  });
  return [116 * y - 16, 500 * (x - y), 200 * (y - z)];
}
