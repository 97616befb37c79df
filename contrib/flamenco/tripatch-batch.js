// SPDX-License-Identifier: GPL-3.0-or-later
//
// Flamenco's job type for `tripatch batch`: portions of a list of files side by side, then one task that gathers their lines and the
// picture of the worst seams. It belongs in the `scripts` folder beside flamenco-manager; `tripatch batch ... --emit flamenco` prints
// the job that is submitted to it. The workers need the program `tripatch`.

const JOB_TYPE = {
    label: "TriPatch: Fill Holes",
    description: "Fills the holes of many mesh files",
    settings: [
        { key: "files", type: "string", subtype: "file_path", required: true,
          description: "A text file with the paths of the meshes, one a line" },
        { key: "out", type: "string", subtype: "dir_path", required: true,
          description: "Folder for the results, which all workers see" },
        { key: "count", type: "int32", required: true, description: "Number of lines of the list" },
        { key: "chunk_size", type: "int32", default: 50, description: "Files that one task does" },
        { key: "options", type: "string", default: "[]", required: false,
          description: "Further words of the command, as a JSON list" },
        { key: "tripatch_cmd", type: "string", default: "tripatch", required: false, visible: "web",
          description: "The program on the workers" },
    ],
};

function compileJob(job) {
    const settings = job.settings;
    if (!(settings.count >= 1) || !(settings.chunk_size >= 1)) {
        throw "count and chunk_size have to be 1 or more";
    }
    const options = JSON.parse(settings.options || "[]");

    const gather = author.Task("gather", "misc");
    gather.addCommand(command(settings, ["--workers", "0"], options));
    for (let first = 1; first <= settings.count; first += settings.chunk_size) {
        const range = `${first}-${Math.min(first + settings.chunk_size - 1, settings.count)}`;
        const fill = author.Task(`fill-${range}`, "misc");
        fill.addCommand(command(settings, ["--range", range], options));
        job.addTask(fill);
        gather.addDependency(fill);
    }
    job.addTask(gather);
}

function command(settings, part, options) {
    return author.Command("exec", {
        exe: settings.tripatch_cmd || "tripatch",
        args: ["batch", "--files", settings.files, ...part, "--out", settings.out, ...options],
    });
}
