# roscd and its like are functions, which Debian keeps where only the completion of words finds them.
if ! type roscd >/dev/null 2>&1 && [ -r /usr/share/zsh/vendor-completions/roszsh ]; then
    . /usr/share/zsh/vendor-completions/roszsh
fi
