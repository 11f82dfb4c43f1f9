/** Decimal: numbers as people type them. */

const DECIMAL = /^[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?$/i;

/** Returns the number of a text such as "-1.5e-3"; NaN for any other text, also for "", "0x10" and "Infinity". */
export function decimal(text: string): number {
  return DECIMAL.test(text) ? Number(text) : NaN;
}
