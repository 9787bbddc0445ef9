# Debian defines functions such as roscd in a file that only shell completion loads.
if ! type roscd >/dev/null 2>&1 && [ -r /usr/share/zsh/vendor-completions/roszsh ]; then
    . /usr/share/zsh/vendor-completions/roszsh
fi
