/** Decimal: numbers as people write them. */

const DECIMAL = /^[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?$/i;

/** The number of a text such as "-1.5e-3"; NaN of any other, also of "", "0x10" and "Infinity". */
export function decimal(text: string): number {
  return DECIMAL.test(text) ? Number(text) : NaN;
}
