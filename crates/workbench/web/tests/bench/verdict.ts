/** Figures of benchmarks beside their limits, each with a word. */
import { expect } from "@playwright/test";

/**
 * Prints each figure with its limit and `met` or `MISSED`. What is missed is noted, so that everything is measured before `end` lets
 * the test fail.
 */
export class Verdicts {
  readonly #missed: string[] = [];

  /** A figure that is at most its limit. `more` stands behind the word. */
  most(what: string, figure: number, limit: number, unit: string, more = "", digits = 1): void {
    this.#judge(`${what}: ${figure.toFixed(digits)} ${unit} (limit ${limit} ${unit})`, figure <= limit, more);
  }

  /** A figure that is at least its limit. */
  least(what: string, figure: number, limit: number, unit: string, more = "", digits = 1): void {
    this.#judge(`${what}: ${figure.toFixed(digits)} ${unit} (at least ${limit} ${unit})`, figure >= limit, more);
  }

  #judge(line: string, met: boolean, more: string): void {
    console.log(`${line}: ${met ? "met" : "MISSED"}${more === "" ? "" : `, ${more}`}`);
    if (!met) this.#missed.push(line);
  }

  /** Fails where a figure missed its limit. */
  end(): void {
    expect(this.#missed, "figures that missed their limits").toEqual([]);
  }
}
