/** The library of plots, which is loaded when the Scope is opened. */
export { default } from "uplot";
