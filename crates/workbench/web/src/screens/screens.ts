/** The screens that are loaded when the first of them is opened. */
export { Compare } from "./compare/compare";
export { Control } from "./control/control";
export { Faults } from "./faults/faults";
export { Overview } from "./overview/overview";
export { Parameters } from "./parameters/parameters";
export { Scope } from "./scope/scope";
export { Virtual } from "./virtual/virtual";
