// Prints what the Khronos glTF validator says of the files named on the command line: a line of JSON for each.
const fs = require("fs");
const validator = require("gltf-validator");
(async () => {
  for (const file of process.argv.slice(2)) {
    const report = await validator.validateBytes(new Uint8Array(fs.readFileSync(file)));
    const { numErrors, numWarnings, messages } = report.issues;
    console.log(JSON.stringify({ errors: numErrors, warnings: numWarnings, messages: messages.map((m) => `${m.code} ${m.pointer}`) }));
  }
})();
