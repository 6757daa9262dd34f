# Signals that end the program: what was done until then is in whole files, nothing else is left behind, and no process goes on.
$ cat >endless.yaml <<'END'
> wisp: 1
> steps: 1000000
> surfaces:
>   - name: flag
>     generate: { shape: plane, columns: 17, rows: 17, spacing: 0.05 }
>     pins: [0, 16]
>     cloth: {}
> output:
>   - { surface: flag, file: end.obj }
> END
$ echo '<script type="application/json" id="wisp-data">null</script>' >viewer.html
$ cat >ended.py <<'END'
> import ctypes, os, signal, subprocess, time
> from os.path import exists
> from signal import SIGINT, SIGKILL, SIGTERM
> ctypes.CDLL( None ).prctl( 36, 1 ) # children of a program that has ended come to us
> def start( command, **variables ):
>     # a shell ignores SIGINT for what it starts in the background
>     return subprocess.Popen( [os.environ["WISP"], *command.split()], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
>                              env={ **os.environ, **variables }, preexec_fn=lambda: signal.signal( SIGINT, signal.SIG_DFL ) )
> def wait_for( path, size ):
>     end = time.time() + 30
>     while not ( exists( path ) and os.path.getsize( path ) >= size ):
>         assert time.time() < end, path
>         time.sleep( 0.01 )
> def finish( run, sent, status ):
>     run.send_signal( sent )
>     said = run.communicate( timeout=30 )
>     assert run.returncode == status, ( run.returncode, said )
>     # hidden files are those that the program writes until they are whole
>     assert [name for name in os.listdir( "." ) if name.startswith( "." )] == []
>     return said
> def end( command, seconds, sent, status, **variables ):
>     run = start( command, **variables )
>     time.sleep( seconds )
>     return finish( run, sent, status )
> def wisp( command ):
>     run = subprocess.run( [os.environ["WISP"], *command.split()], capture_output=True, text=True )
>     assert run.returncode == 0, ( command, run )
>     return run.stdout
> def expect_no_process():
>     time.sleep( 0.1 )
>     try:
>         while os.waitpid( -1, os.WNOHANG )[0] > 0: # ended with its parent
>             pass
>         assert False, "a process goes on"
>     except ChildProcessError:
>         pass
> END

# An interrupted run leaves whole files and its summary; its frames are those of a run that was not interrupted. SIGTERM is answered in the same way.
$ python3 <<'END'
> from ended import *
> run = start( "run endless.yaml --record run.wisp --track flag:3 --track-file track.csv" )
> wait_for( "run.wisp", 50000 )
> out, err = finish( run, SIGINT, 130 )
> assert err == "" and "\ninterrupted  at step " in out and "\nnot written  end.obj\n" in out and "\nhash " in out and not exists( "end.obj" )
> steps = int( out.split( "at step " )[1].split( " of 1000000" )[0] )
> info = wisp( "info run.wisp" )
> assert f"recording of {steps + 1} frames" in info and "no defects" in info
> assert len( open( "track.csv" ).readlines() ) == steps + 2 # the header and the start
> wisp( f"run endless.yaml --steps {steps} --verify run.wisp" )
> end( "run endless.yaml --record term.pc2 --track flag:1 --track-file term.csv -o term.json -f json", 0.5, SIGTERM, 143 )
> wisp( "info term.pc2" )
> assert "results, 1 rows" in wisp( "info term.json" )
> END

# A second signal ends the program at once: nobody reads the summary, so that it waits after the first one.
$ python3 <<'END'
> from ended import *
> os.mkfifo( "nobody", 0o600 )
> run = start( "run endless.yaml -o nobody" )
> time.sleep( 0.3 )
> run.send_signal( SIGINT )
> time.sleep( 0.3 )
> assert run.poll() is None
> finish( run, SIGINT, -SIGINT )
> END

# A killed run leaves no half of a file, where the file system has files without a name, and all frames of a recording of ours. A reader that leaves early costs no file.
$ python3 <<'END'
> from ended import *
> try:
>     os.close( os.open( ".", os.O_TMPFILE | os.O_WRONLY, 0o600 ) )
>     end( "run endless.yaml --record killed.usda", 0.5, SIGKILL, -SIGKILL )
>     assert not exists( "killed.usda" )
> except OSError:
>     pass
> END
$ python3 <<'END'
> from ended import *
> end( "run endless.yaml --record killed.wisp", 0.5, SIGKILL, -SIGKILL )
> info = wisp( "info killed.wisp" )
> assert int( info.split( "recording of " )[1].split()[0] ) > 1 and "wrong: the recording was " in info and info.count( "wrong" ) == 1
> END
$ wisp run endless.yaml --steps 20 --record early.wisp | true; wisp info --keys | head -n 1 >first.txt; wisp info early.wisp
...recording of 21 frames...

# Pictures that are whole are kept, and others are not written. A page has the hashes until then. A search that has only begun has nothing to keep.
$ python3 <<'END'
> from ended import *
> run = start( "render endless.yaml --frames 0:2000:1 --size 64x48 -o film.png" )
> wait_for( "film_0002.png", 1 )
> out, err = finish( run, SIGINT, 130 )
> assert "film_0001.png: the first of " in out and "interrupted at picture " in out and open( "film_0002.png", "rb" ).read()[-8:-4] == b"IEND"
> end( "render endless.yaml --frame 0 --size 4000x3000 --samples 4096 -o huge.png", 0.5, SIGINT, 130 )
> assert not exists( "huge.png" )
> out, err = end( "view endless.yaml --steps 1000000 -o page.html", 0.7, SIGTERM, 143, WISP_DATA="." )
> assert "wisp: interrupted at step " in err and '"hashes":{"every":60' in open( "page.html" ).read()
> out, err = end( "tune endless.yaml --error 0.001 --length 100 -o tuned.yaml", 0.4, SIGINT, 130 )
> assert err == "wisp: interrupted by Ctrl-C\n" and not exists( "tuned.yaml" )
> END

# A benchmark writes what it has.
$ python3 <<'END'
> from ended import *
> end( "bench balloon --quick --output bench.json --format json --report bench.html", 1.5, SIGINT, 130 )
> wisp( "info bench.json" )
> page = open( "bench.html" ).read()
> assert "interrupted: " in page and "</html>" in page
> END

# Processes of the torture end with it, and a gate that counts instructions stops valgrind, where it is installed.
$ python3 <<'END'
> from ended import *
> out, err = end( "torture --limit 1000 endless.yaml", 1.5, SIGTERM, 143 )
> assert "interrupted  after " in out
> expect_no_process()
> end( "torture --limit 1000 endless.yaml", 1.5, SIGKILL, -SIGKILL )
> expect_no_process()
> END
$ printf 'wisp: 1\nsteps: 1500\nsurfaces: [{ name: flag, generate: { shape: plane, columns: 17, rows: 17, spacing: 0.05 }, cloth: {} }]\n' >short.yaml
> printf 'wisp_suite: 1\nscenes:\n  - { file: short.yaml }\n' >suite.yaml; printf 'as it was' >base.json; python3 <<'END'
> from ended import *
> import shutil
> if shutil.which( "valgrind" ):
>     out, err = end( "gate record suite.yaml -o base.json", 4, SIGTERM, 143 )
>     assert err == "wisp: interrupted after 0 of 1 rows: base.json is as it was\n" and open( "base.json" ).read() == "as it was"
>     expect_no_process()
> END
