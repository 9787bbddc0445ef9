# roscd and its like are functions, which Debian keeps where only the completion of words finds them.
if ! type roscd >/dev/null 2>&1 && [ -r /usr/share/bash-completion/completions/rosbash ]; then
    . /usr/share/bash-completion/completions/rosbash
fi
