/** The screens that are loaded when the first of them is opened. */

export { Capture } from "./capture/capture";
export { Compare } from "./compare/compare";
export { Control } from "./control/control";
export { Faults } from "./faults/faults";
export { Log } from "./log/log";
export { Machine } from "./machine/machine";
export { Overview } from "./overview/overview";
export { Parameters } from "./parameters/parameters";
export { Scope } from "./scope/scope";
export { Telegram } from "./telegram/telegram";
export { Virtual } from "./virtual/virtual";
