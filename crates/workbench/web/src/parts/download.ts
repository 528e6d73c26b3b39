/** Lets the browser save a file. */
export function download(name: string, content: Blob): void {
  const address = URL.createObjectURL(content);
  const link = document.createElement("a");
  link.href = address;
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(address), 10_000);
}

/** The same with a text of this type. */
export function downloadText(name: string, type: string, text: string): void {
  download(name, new Blob([text], { type }));
}
