import { render } from "preact";
import { App } from "./app/App";
import { keepFocus } from "./app/focus";
import { enter } from "./store/live";
import "uplot/dist/uPlot.min.css";
import "./style/base.css";
import "./style/pages.css";

const root = document.getElementById("app");
if (root) {
  render(<App />, root);
  keepFocus();
  void enter();
}
