//! Chromium, driven as a user drives it: clicks, keys and the wheel, by its own protocol over a pipe.

use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::time::Duration;

use serde_json::{Value, json};

/// A page of 1280 x 800 in a browser without a network.
pub struct Browser {
    child: Child,
    input: ChildStdin,
    output: BufReader<ChildStdout>,
    session: Option<String>,
    sent: u64,
}

impl Browser {
    /// Opens a page and waits until it is drawn; `None` if there is no Chromium.
    pub fn open(folder: &Path, file: &str) -> Option<Self> {
        // Chromium reads commands from descriptor 3 and answers on 4. It ends by itself if nobody ends it.
        let pipe = "exec timeout 300 chromium \"$@\" 3<&0 4>&1 >&2 </dev/null";
        let profile = format!("--user-data-dir={}", folder.join("profile").display());
        let flags = [
            "--headless=new",
            "--no-sandbox",
            "--use-angle=swiftshader",
            "--enable-unsafe-swiftshader",
            "--hide-scrollbars",
            "--host-resolver-rules=MAP * ~NOTFOUND",
            "--remote-debugging-pipe",
        ];
        Command::new("chromium").arg("--version").output().ok().filter(|ran| ran.status.success())?;
        let mut program = Command::new("sh");
        program.args(["-c", pipe, "sh"]).args(flags).arg(profile);
        let mut child = program.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
        let (input, output) = (child.stdin.take().unwrap(), BufReader::new(child.stdout.take().unwrap()));
        let mut browser = Self { child, input, output, session: None, sent: 0 };
        let address = format!("file://{}/{file}", folder.display());
        let target = browser.ask("Target.createTarget", json!({ "url": address }))["targetId"].clone();
        let attached = browser.ask("Target.attachToTarget", json!({ "targetId": target, "flatten": true }));
        browser.session = Some(attached["sessionId"].as_str().unwrap().to_owned());
        let size = json!({ "width": 1280, "height": 800, "deviceScaleFactor": 1, "mobile": false });
        browser.ask("Emulation.setDeviceMetricsOverride", size);
        for _ in 0..600 {
            if browser.value("document.body && document.body.dataset.drawn") == "yes" {
                return Some(browser);
            }
            std::thread::sleep(Duration::from_millis(100));
        }
        panic!("{file} was not drawn within a minute: is there an error in its program?");
    }

    /// The answer to a command.
    fn ask(&mut self, method: &str, parameters: Value) -> Value {
        self.sent += 1;
        let mut command = json!({ "id": self.sent, "method": method, "params": parameters });
        if let Some(session) = &self.session {
            command["sessionId"] = json!(session);
        }
        self.input.write_all(format!("{command}\0").as_bytes()).unwrap();
        self.input.flush().unwrap();
        loop {
            let mut message = Vec::new();
            self.output.read_until(0, &mut message).unwrap();
            assert_eq!(message.pop(), Some(0), "the browser has ended");
            let message: Value = serde_json::from_slice(&message).unwrap();
            if message["id"] == self.sent {
                assert!(message.get("error").is_none(), "{method}: {message}");
                return message["result"].clone();
            }
        }
    }

    /// What JavaScript says.
    pub fn value(&mut self, expression: &str) -> Value {
        let answer = self.ask("Runtime.evaluate", json!({ "expression": expression, "returnByValue": true }));
        assert!(answer.get("exceptionDetails").is_none(), "{expression}: {answer}");
        answer["result"]["value"].clone()
    }

    fn mouse(&mut self, kind: &str, [x, y]: [f64; 2], more: Value) {
        let mut event = json!({ "type": kind, "x": x, "y": y, "button": "left", "clickCount": 1 });
        event.as_object_mut().unwrap().extend(more.as_object().unwrap().clone());
        self.ask("Input.dispatchMouseEvent", event);
    }

    pub fn click(&mut self, at: [f64; 2]) {
        self.mouse("mousePressed", at, json!({}));
        self.mouse("mouseReleased", at, json!({}));
    }

    /// Clicks into the middle of the element with this id.
    pub fn click_on(&mut self, id: &str) {
        let middle = format!(
            "(() => {{ const e = document.getElementById('{id}'); e.scrollIntoView(); const b = e.getBoundingClientRect(); \
             return [b.x + b.width / 2, b.y + b.height / 2]; }})()"
        );
        let middle = serde_json::from_value(self.value(&middle)).unwrap();
        self.click(middle);
    }

    pub fn drag(&mut self, from: [f64; 2], to: [f64; 2]) {
        self.mouse("mousePressed", from, json!({}));
        self.mouse("mouseMoved", to, json!({ "buttons": 1 }));
        self.mouse("mouseReleased", to, json!({}));
    }

    pub fn wheel(&mut self, at: [f64; 2], by: f64) {
        self.mouse("mouseWheel", at, json!({ "deltaX": 0, "deltaY": by, "button": "none" }));
    }

    /// Presses a key that writes nothing, as `ArrowDown`, which has the number 40.
    pub fn key(&mut self, name: &str, number: u32) {
        for kind in ["rawKeyDown", "keyUp"] {
            let event = json!({ "type": kind, "key": name, "code": name, "windowsVirtualKeyCode": number });
            self.ask("Input.dispatchKeyEvent", event);
        }
    }

    /// The picture of the scene, as text.
    pub fn picture(&mut self) -> String {
        self.value("document.getElementById('view').toDataURL()").as_str().unwrap().to_owned()
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        // Its pipe is closed first, by which it ends; what is left of it ends by the signal.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
