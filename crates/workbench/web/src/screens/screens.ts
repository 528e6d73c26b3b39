/** The screens that are loaded when the first of them is opened. */
export { Faults } from "./faults/faults";
export { Overview } from "./overview/overview";
export { Virtual } from "./virtual/virtual";
