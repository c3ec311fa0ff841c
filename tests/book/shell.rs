//! The shell of the pages, as little as they need: words, quotes, variables before a command, `echo ... | command`,
//! comments. What is more than that is refused, so that no line is passed over. Nothing runs here.

/// A line of a block of `sh`.
#[derive(Debug, Default, PartialEq, Eq)]
pub struct Command {
    pub words: Vec<String>,
    /// What stands on its standard input.
    pub input: Option<String>,
    /// The exit code that it is said to have, and why.
    pub code: i32,
    pub why: String,
}

/// A word, or what stands between commands.
#[derive(Debug, PartialEq, Eq)]
enum Token {
    Word(String),
    Pipe,
}

/// The command of a line; `None` where it has none.
pub fn parse(line: &str) -> Result<Option<Command>, String> {
    let (tokens, comment) = tokens(line)?;
    let (code, why) = code(comment)?;
    let mut command = Command { code, why: why.to_owned(), ..Command::default() };
    let stages: Vec<&[Token]> = tokens.split(|token| *token == Token::Pipe).collect();
    let words = |stage: &[Token]| -> Vec<String> {
        let word =
            |token: &Token| if let Token::Word(word) = token { Some(word.clone()) } else { None };
        stage.iter().filter_map(word).collect()
    };
    match stages[..] {
        [[]] => return Ok(None),
        [stage] => command.words = words(stage),
        [first, second] if !second.is_empty() => {
            let told = words(first);
            match told.split_first() {
                Some((echo, text)) if echo == "echo" => command.input = Some(text.join(" ") + "\n"),
                _ => return Err("before a pipe only `echo` is understood".to_owned()),
            }
            command.words = words(second);
        }
        _ => return Err("one pipe between two commands is understood".to_owned()),
    }
    Ok(Some(command))
}

/// The exit code that a comment tells of: `exit code 1: why`.
fn code(comment: &str) -> Result<(i32, &str), String> {
    let Some(told) = comment.trim().strip_prefix("exit code") else { return Ok((0, "")) };
    match told.split_once(':').map(|(code, why)| (code.trim(), why.trim())) {
        None | Some((_, "")) => {
            Err("an exit code needs its reason: `# exit code 1: why`".to_owned())
        }
        Some(("1", why)) => Ok((1, why)),
        Some(("2", why)) => Ok((2, why)),
        Some((code, _)) => {
            Err(format!("there is no exit code `{code}`: a check that failed gives 1, bad input 2"))
        }
    }
}

/// The words of a line, and what stands behind `#`.
fn tokens(line: &str) -> Result<(Vec<Token>, &str), String> {
    let mut tokens = Vec::new();
    let mut word: Option<String> = None;
    let end_word = |word: &mut Option<String>, tokens: &mut Vec<Token>| {
        tokens.extend(word.take().map(Token::Word));
    };
    let mut chars = line.char_indices();
    while let Some((at, c)) = chars.next() {
        match c {
            ' ' => end_word(&mut word, &mut tokens),
            '#' if word.is_none() => return Ok((tokens, &line[at + 1..])),
            '|' => {
                end_word(&mut word, &mut tokens);
                tokens.push(Token::Pipe);
            }
            '\'' | '"' => {
                let quoted = word.get_or_insert_default();
                loop {
                    match chars.next() {
                        None => return Err(format!("a quote {c} does not end")),
                        Some((_, end)) if end == c => break,
                        Some((_, '$' | '`' | '\\')) if c == '"' => {
                            return Err(
                                "`$`, backticks and `\\` in double quotes are not understood"
                                    .to_owned(),
                            );
                        }
                        Some((_, inside)) => quoted.push(inside),
                    }
                }
            }
            ';' | '&' | '<' | '>' | '$' | '`' | '(' | ')' | '*' | '?' | '[' | ']' | '{' | '}'
            | '~' | '!' | '\\' | '\t' => {
                return Err(format!("`{c}` is not understood here"));
            }
            c => word.get_or_insert_default().push(c),
        }
    }
    end_word(&mut word, &mut tokens);
    Ok((tokens, ""))
}
